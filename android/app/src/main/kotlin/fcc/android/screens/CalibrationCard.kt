package fcc.android.screens

import android.app.Activity
import android.content.pm.ActivityInfo
import android.view.HapticFeedbackConstants
import android.view.View
import android.view.ViewGroup
import android.widget.Button
import android.widget.ProgressBar
import android.widget.TextView
import fcc.android.CalibrationOffer
import fcc.android.CalibrationState
import fcc.android.Calibrations
import fcc.android.Flight
import fcc.android.Phase
import fcc.android.R
import fcc.android.StatePoller
import kotlin.math.roundToInt

/** Calibrations: what is offered, and the one that goes on, step by step. */
internal class CalibrationCard(private val activity: Activity, view: View) {
    private val guide: View = view.findViewById(R.id.calibration_guide)
    private val title: TextView = view.findViewById(R.id.calibration_title)
    private val next: TextView = view.findViewById(R.id.calibration_next)
    private val bar: ProgressBar = view.findViewById(R.id.calibration_progress)
    private val details = Rows(view.findViewById(R.id.calibration_details))
    private val cancel: Button = view.findViewById(R.id.calibration_cancel)
    private val found = Rows(view.findViewById(R.id.calibrations_found))
    private val offers: ViewGroup = view.findViewById(R.id.calibrations)
    private var offered = emptyList<String>()
    private val poller = StatePoller(SHOWN_EVERY_MS, { Calibrations.shown(activity.applicationContext) }, ::show)

    init {
        cancel.setOnClickListener { Calibrations.end() }
    }

    fun enter() {
        Calibrations.look(activity.applicationContext)
        poller.start()
    }

    /** One that goes on is given up, unless the activity is made anew. */
    fun leave() {
        poller.stop()
        if (!activity.isChangingConfigurations) Calibrations.end()
        follow(isRunning = false)
    }

    private fun show(shown: Calibrations.Shown) {
        val state = shown.state
        guide.showIf(state != null)
        if (state != null) show(state)
        follow(state?.isRunning == true)
        found.show(foundRows(shown))
        offer(shown.offered.map { it.kind })
    }

    private fun show(state: CalibrationState) {
        title.show(nameOf(state.kind))
        val words = state.found?.let { activity.getString(R.string.calibration_done, it) }
            ?: state.refused?.let { activity.getString(R.string.calibration_refused, it) }
            ?: state.next.ifEmpty { activity.getString(R.string.calibration_begins) }
                .replaceFirstChar(Char::uppercase)
        if (words != next.text.toString()) {
            next.text = words
            // Felt, too: the phone may lie on its screen.
            next.performHapticFeedback(HapticFeedbackConstants.LONG_PRESS)
        }
        val tone = if (state.found != null) Tone.GOOD else if (state.refused != null) Tone.BAD else Tone.PLAIN
        next.setTextColor(activity.getColor(tone.color))
        bar.showIf(state.isRunning)
        bar.progress = (state.progress * bar.max).roundToInt()
        details.show(if (state.isRunning) rowsOf(state) else emptyList())
        cancel.setText(if (state.isRunning) R.string.cancel else R.string.close)
    }

    private fun rowsOf(state: CalibrationState) = listOfNotNull(
        Row(state.beforehand, tone = Tone.DIM),
        Row(activity.getString(if (state.isAtRest) R.string.at_rest else R.string.moving)),
        state.held.takeIf { it.isNotEmpty() }?.let { Row(activity.getString(R.string.sides_held, it.joinToString())) },
        state.missing.takeIf { it.isNotEmpty() }
            ?.let { Row(activity.getString(R.string.sides_missing, it.joinToString()), tone = Tone.DIM) },
        state.covered?.let { Row(activity.getString(R.string.directions_covered, (it * PERCENT).roundToInt())) },
    )

    private fun foundRows(shown: Calibrations.Shown): List<Row> {
        val problem = shown.problem?.let { Row(it, tone = Tone.BAD) }
        val words = if (Flight.phase == Phase.IDLE) R.string.calibrations_none else R.string.calibrations_in_flight
        val none = Row(activity.getString(words), tone = Tone.DIM)
        return listOfNotNull(problem) + shown.offered.map { foundRow(it) }
            .ifEmpty { listOf(none).filter { shown.state == null && problem == null } }
    }

    private fun foundRow(offer: CalibrationOffer) = Row(
        offer.found ?: activity.getString(R.string.not_calibrated, offer.kind),
        tone = if (offer.found == null) Tone.DIM else Tone.PLAIN,
    )

    private fun offer(kinds: List<String>) {
        if (kinds == offered) return
        offered = kinds
        offers.removeAllViews()
        for (kind in kinds) {
            val button = activity.layoutInflater.inflate(R.layout.calibrate, offers, false) as Button
            button.text = activity.getString(R.string.calibrate, kind)
            button.setOnClickListener { Calibrations.begin(activity.applicationContext, kind) }
            offers.addView(button)
        }
    }

    private fun nameOf(kind: String) = activity.getString(R.string.calibration_of, kind)

    /** While it goes on, the screen neither turns with the phone nor goes off. */
    private fun follow(isRunning: Boolean) {
        activity.requestedOrientation =
            if (isRunning) ActivityInfo.SCREEN_ORIENTATION_LOCKED else ActivityInfo.SCREEN_ORIENTATION_UNSPECIFIED
        guide.keepScreenOn = isRunning
    }

    private companion object {
        const val SHOWN_EVERY_MS = 200L
        const val PERCENT = 100
    }
}
