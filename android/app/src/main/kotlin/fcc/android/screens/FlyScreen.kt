package fcc.android.screens

import android.app.Activity
import android.os.SystemClock
import android.view.View
import android.view.WindowManager
import android.widget.Button
import android.widget.TextView
import fcc.android.Commands
import fcc.android.FlightState
import fcc.android.Phase
import fcc.android.R
import fcc.android.Tick
import kotlin.math.PI
import kotlin.math.roundToInt

/** The flight: the large switch, attitude, and three quantities beside their set points. */
internal class FlyScreen(
    private val activity: Activity,
    private val start: () -> Unit,
    private val end: () -> Unit,
) : Screen {
    override val view: View = activity.layoutInflater.inflate(R.layout.fly, null)
    private val state: TextView = view.findViewById(R.id.state)
    private val mode: TextView = view.findViewById(R.id.mode)
    private val problem: TextView = view.findViewById(R.id.problem)
    private val timing: TextView = view.findViewById(R.id.timing)
    private val attitude: AttitudeView = view.findViewById(R.id.attitude)
    private val switch: Button = view.findViewById(R.id.engage)
    private val endFlight: Button = view.findViewById(R.id.end_flight)
    private val heading = SetPointRow(view.findViewById(R.id.heading), ::refused)
    private val altitude = SetPointRow(view.findViewById(R.id.altitude), ::refused)
    private val airspeed = SetPointRow(view.findViewById(R.id.airspeed), ::refused)

    private var offered: Offer? = null
    private var offeredAtMs = 0L
    private var refusal: String? = null
    private var refusedAtMs = 0L

    init {
        switch.setOnClickListener { press() }
        endFlight.setOnClickListener { end() }
    }

    override fun show(state: FlightState) {
        val now = state.now.takeIf { state.phase == Phase.FLYING }
        this.state.show(now?.let { words(activity, it) } ?: activity.getString(state.phase.words))
        this.state.setTextColor(activity.getColor(colorOf(now)))
        mode.show(now?.let { activity.getString(R.string.mode, it.mode) }.orEmpty())
        mode.showIf(now?.hasControl == true)
        showProblem(state, now)
        attitude.show(now?.rollRad, now?.pitchRad)
        heading.show(quantities.heading, now?.headingRad, now?.desired?.headingRad)
        altitude.show(quantities.altitude(now), now?.altitudeM, now?.desired?.altitudeM)
        airspeed.show(quantities.airspeed, now?.airspeedMps, now?.desired?.airspeedMps)
        timing.show(timingOf(state, now))
        offer(offerOf(state, now))
        // Released first, then ended: no flight ends by a wrong touch.
        endFlight.isEnabled = state.phase == Phase.FLYING && now?.hasControl != true
        endFlight.showIf(state.phase == Phase.FLYING)
        keepScreenOn(state.phase != Phase.IDLE)
    }

    override fun leave() = keepScreenOn(false)

    private val quantities = Quantities(activity)

    private fun colorOf(now: Tick?): Int = when (now?.state) {
        "engaged" -> R.color.good
        "failsafe" -> R.color.bad
        else -> R.color.text
    }

    private fun showProblem(state: FlightState, now: Tick?) {
        if (SystemClock.uptimeMillis() - refusedAtMs > REFUSAL_SHOWN_MS) refusal = null
        val lines = listOfNotNull(
            refusal,
            now?.faults?.takeIf { it.isNotEmpty() }?.joinToString(),
            // The cause, before what follows from it.
            now?.takeIf { !it.hasControl && it.isSilent }?.let { activity.silence(state) },
            now?.takeIf { !it.hasControl && it.engageInhibits.isNotEmpty() }
                ?.let { activity.getString(R.string.inhibited, it.engageInhibits.joinToString()) },
            state.ending?.takeIf { state.phase == Phase.IDLE }
                ?.let { activity.getString(R.string.last_flight, it) },
        )
        problem.show(lines.distinct().joinToString("\n"))
        problem.showIf(lines.isNotEmpty())
        // That a flight has ended is no fault; that none began is one.
        val isEnd = state.phase == Phase.IDLE && state.sources.isNotEmpty() && refusal == null
        problem.setTextColor(activity.getColor(if (isEnd) R.color.text_dim else R.color.bad))
    }

    private fun timingOf(state: FlightState, now: Tick?): String {
        if (now == null) return ""
        val late = activity.duration(now.latenessUs)
        val lateness = state.timing?.let {
            val (p99, most) = activity.duration(it.latenessP99Us) to activity.duration(it.latenessMaxUs)
            activity.getString(R.string.lateness, late, p99, most)
        } ?: activity.getString(R.string.lateness_now, late)
        return lateness + "\n" + activity.getString(R.string.missed, now.missed, now.overruns)
    }

    /** What the large switch does. */
    private enum class Offer(val text: Int, val background: Int, val isEnabled: Boolean) {
        START(R.string.start, R.drawable.switch_start, true),
        STARTING(R.string.phase_beginning, R.drawable.switch_start, false),
        ENGAGE(R.string.engage, R.drawable.switch_engage, true),
        INHIBITED(R.string.engage, R.drawable.switch_engage, false),
        DISENGAGE(R.string.disengage, R.drawable.switch_disengage, true),
        ENDING(R.string.phase_ending, R.drawable.switch_start, false),
    }

    private fun offerOf(state: FlightState, now: Tick?): Offer = when (state.phase) {
        Phase.IDLE -> Offer.START
        Phase.BEGINNING -> Offer.STARTING
        Phase.ENDING -> Offer.ENDING
        Phase.FLYING -> when {
            now == null -> Offer.INHIBITED
            now.hasControl -> Offer.DISENGAGE
            now.engageInhibits.isEmpty() -> Offer.ENGAGE
            else -> Offer.INHIBITED
        }
    }

    private fun offer(offer: Offer) {
        if (offer == offered) return
        offered = offer
        offeredAtMs = SystemClock.uptimeMillis()
        switch.setText(offer.text)
        switch.setBackgroundResource(offer.background)
        switch.isEnabled = offer.isEnabled
        switch.contentDescription = if (offer == Offer.START) activity.getString(R.string.start_described) else null
    }

    /** A second touch of a hasty finger does not undo what the first one did. */
    private fun press() {
        val isNew = SystemClock.uptimeMillis() - offeredAtMs < HASTE_MS
        when (offered) {
            Offer.DISENGAGE -> if (!isNew) Commands.disengage(::refused)
            Offer.ENGAGE -> if (!isNew) Commands.engage(::refused)
            Offer.START -> if (!isNew) start()
            else -> Unit
        }
    }

    private fun refused(why: String) {
        refusal = why
        refusedAtMs = SystemClock.uptimeMillis()
    }

    private fun keepScreenOn(isOn: Boolean) {
        val flag = WindowManager.LayoutParams.FLAG_KEEP_SCREEN_ON
        if (isOn) activity.window.addFlags(flag) else activity.window.clearFlags(flag)
    }

    private companion object {
        const val HASTE_MS = 500L
        const val REFUSAL_SHOWN_MS = 8_000L
    }
}

/** The three quantities, in the units that pilots read. */
private class Quantities(private val activity: Activity) {
    val heading = Quantity(
        R.string.heading,
        "heading_rad",
        5 * Units.DEGREE_RAD,
        activity::heading,
    ) { rad -> toWhole(rad, 5 * Units.DEGREE_RAD).mod(2 * PI) }

    val airspeed = Quantity(
        R.string.airspeed,
        "airspeed_mps",
        Units.KNOT_MPS,
        activity::knots,
    ) { mps -> toWhole(mps, Units.KNOT_MPS) }

    private val pressureAltitude = altitude(R.string.pressure_altitude, "pressure_altitude_m")
    private val altitude = altitude(R.string.altitude, "altitude_m")
    private val height = altitude(R.string.height, "height_m")

    /** As it is shown: above the same reference. */
    fun altitude(now: Tick?): Quantity = when (now?.altitudeReference) {
        "pressure-level" -> pressureAltitude
        "field" -> height
        else -> altitude
    }

    private fun altitude(label: Int, setPoint: String) =
        Quantity(label, setPoint, 50 * Units.FOOT_M, activity::feet) { m -> toWhole(m, 10 * Units.FOOT_M) }

    private fun toWhole(value: Double, unit: Double) = (value / unit).roundToInt() * unit
}
