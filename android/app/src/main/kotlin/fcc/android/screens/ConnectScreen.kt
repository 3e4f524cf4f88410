package fcc.android.screens

import android.Manifest
import android.app.Activity
import android.content.pm.PackageManager
import android.os.Build
import android.os.SystemClock
import android.view.View
import android.widget.Button
import android.widget.TextView
import fcc.android.Battery
import fcc.android.FlightState
import fcc.android.Phase
import fcc.android.Positions
import fcc.android.R
import fcc.android.SensorHealth
import fcc.android.Wifi
import kotlin.math.roundToInt

/** What is connected, and what arrives; what the system permits. */
internal class ConnectScreen(
    private val activity: Activity,
    private val start: () -> Unit,
    private val end: () -> Unit,
) : Screen {
    override val view: View = activity.layoutInflater.inflate(R.layout.connect, null)
    private val state: TextView = view.findViewById(R.id.connect_state)
    private val startOrEnd: Button = view.findViewById(R.id.start)
    private val flown = Rows(view.findViewById(R.id.flown))
    private val readings = Rows(view.findViewById(R.id.readings))
    private val sensors = Rows(view.findViewById(R.id.sensors))
    private val remarks = Rows(view.findViewById(R.id.remarks))
    private val permissions = Rows(view.findViewById(R.id.permissions))
    private val battery = Rows(view.findViewById(R.id.battery))
    private val events = Rows(view.findViewById(R.id.events))
    private val calibrations = CalibrationCard(activity, view)
    private var phase = Phase.IDLE
    private var unreachable = emptyList<Row>()
    private var lookedAtMs = 0L

    init {
        startOrEnd.setOnClickListener {
            when (phase) {
                Phase.IDLE -> start()
                Phase.FLYING -> end()
                else -> Unit
            }
        }
        view.findViewById<Button>(R.id.open_battery_settings).setOnClickListener { Battery.openSettings(activity) }
        view.findViewById<Button>(R.id.open_app_settings).setOnClickListener { Battery.openAppSettings(activity) }
    }

    override fun enter() {
        calibrations.enter()
        look()
    }

    /** What the user, or a battery that is nearly empty, may change at any time. */
    private fun look() {
        lookedAtMs = SystemClock.uptimeMillis()
        permissions.show(permissionRows())
        val isLimited = Battery.isLimited(activity)
        val saving = Row(text(R.string.battery_saver), tone = Tone.BAD).takeIf { Battery.isSaving(activity) }
        val limited = if (isLimited) R.string.battery_limited else R.string.battery_unlimited
        battery.show(listOfNotNull(saving, Row(text(limited))))
        val isUnreachable = Wifi.isOffInAirplaneMode(activity)
        unreachable = if (isUnreachable) listOf(Row(text(R.string.airplane_mode), tone = Tone.BAD)) else emptyList()
    }

    override fun leave() = calibrations.leave()

    override fun show(state: FlightState) {
        if (SystemClock.uptimeMillis() - lookedAtMs > LOOKED_EVERY_MS) look()
        phase = state.phase
        val now = state.now.takeIf { state.phase == Phase.FLYING }
        this.state.show(now?.let { words(activity, it) } ?: text(state.phase.words))
        flown.show(flownRows(state) + unreachable)
        readings.show(readingRows(state))
        val none = if (state.phase == Phase.IDLE) R.string.arrives_idle else R.string.phone_sensors_none
        sensors.show(state.sensors.flatMap(::sensorRows).ifEmpty { dim(none) })
        remarks.show(state.remarks, text(R.string.no_remarks))
        events.show(state.reports.takeLast(EVENTS).reversed(), text(R.string.no_events))
        startOrEnd.setText(if (state.phase == Phase.IDLE) R.string.start else R.string.end_flight)
        startOrEnd.isEnabled = state.phase == Phase.IDLE || (state.phase == Phase.FLYING && now?.hasControl != true)
    }

    private fun flownRows(state: FlightState): List<Row> {
        if (state.phase == Phase.IDLE) {
            val tone = if (state.sources.isEmpty()) Tone.BAD else Tone.PLAIN
            val ending = state.ending?.let { Row(activity.getString(R.string.last_flight, it), tone = tone) }
            return listOfNotNull(ending, Row(text(R.string.flown_idle), tone = Tone.DIM))
        }
        if (state.sources.isEmpty()) return emptyList()
        val nothing = text(R.string.nothing)
        val from = state.sources.joinToString().ifEmpty { nothing }
        val to = state.actuators.joinToString().ifEmpty { nothing }
        val recording = state.recording
        val granted = state.granted
        val timing = state.timing
        return listOfNotNull(
            Row(activity.getString(R.string.flown_from, from, to)),
            if (granted != null && timing != null) {
                Row(
                    activity.getString(
                        R.string.loop_granted, granted.policy, granted.nice, timing.rateHz, timing.timer,
                    ),
                )
            } else {
                null
            },
            state.performanceHints?.let { hints ->
                Row(
                    hints.why?.let { activity.getString(R.string.hints_none, it) }
                        ?: activity.getString(R.string.hints_given, activity.duration(hints.targetUs)),
                )
            },
            when {
                recording == null -> null
                recording.stopped != null ->
                    Row(activity.getString(R.string.recording_stopped, recording.stopped), tone = Tone.BAD)
                recording.notRecorded > 0 -> Row(
                    activity.getString(R.string.recording_lost, bytes(recording.bytes), recording.notRecorded),
                    tone = Tone.BAD,
                )
                else -> Row(activity.getString(R.string.recording_to, bytes(recording.bytes)))
            },
        )
    }

    private fun readingRows(state: FlightState): List<Row> {
        val now = state.now.takeIf { state.phase != Phase.IDLE } ?: return dim(R.string.arrives_idle)
        val inhibits = (now.engageInhibits + now.faults).distinct().map { Row(it, tone = Tone.BAD) }
        if (now.readings.isEmpty()) return inhibits + dim(R.string.arrives_nothing)
        return inhibits + now.readings.map { reading ->
            val source = state.sources.getOrNull(reading.source).takeIf { state.sources.size > 1 }
            Row(
                listOfNotNull(reading.name, source).joinToString(": "),
                activity.age(reading.ageMs),
                if (reading.isOld) Tone.BAD else Tone.GOOD,
            )
        }
    }

    private fun sensorRows(sensor: SensorHealth): List<Row> {
        val (measured, asked) = sensor.measuredHz to sensor.askedHz
        val rate = if (measured != null && asked != null) {
            activity.getString(R.string.sensor_rate, measured, asked)
        } else {
            text(R.string.sensor_waiting)
        }
        val details = listOfNotNull(
            sensor.name.takeIf { it.isNotEmpty() },
            text(R.string.sensor_uncalibrated).takeIf { sensor.isUncalibrated },
            sensor.clock?.let { activity.getString(R.string.sensor_clock, it) },
            sensor.accuracy?.let { activity.getString(R.string.sensor_accuracy, it) },
            sensor.ageMs?.let { activity.age(it) },
        )
        return listOfNotNull(
            Row(sensor.kind, rate, if (sensor.trouble != null || sensor.isSlow) Tone.BAD else Tone.GOOD),
            sensor.trouble?.let { Row(it, tone = Tone.BAD) },
            details.takeIf { it.isNotEmpty() }?.let { Row(it.joinToString(), tone = Tone.DIM) },
        )
    }

    private fun permissionRows(): List<Row> {
        val hasLocation = Positions.isPermitted(activity)
        val hasNotifications = Build.VERSION.SDK_INT < Build.VERSION_CODES.TIRAMISU ||
            activity.checkSelfPermission(Manifest.permission.POST_NOTIFICATIONS) == PackageManager.PERMISSION_GRANTED
        fun row(isPermitted: Boolean, permitted: Int, refused: Int) =
            Row(text(if (isPermitted) permitted else refused))
        return listOf(
            row(hasLocation, R.string.location_permitted, R.string.location_refused),
            row(hasNotifications, R.string.notifications_permitted, R.string.notifications_refused),
        )
    }

    private fun dim(text: Int) = listOf(Row(text(text), tone = Tone.DIM))

    private fun text(id: Int) = activity.getString(id)

    private companion object {
        const val EVENTS = 12

        /** Seldom: other processes answer. */
        const val LOOKED_EVERY_MS = 2_000L
    }
}

/** The age of a reading, steady enough to be read. */
private fun Activity.age(ms: Double): String = when {
    ms < 1_000.0 -> "%d ms".format(ms.roundToInt())
    else -> "%.1f s".format(ms / 1e3)
}
