package fcc.android.screens

import android.content.Context
import fcc.android.FlightState
import fcc.android.Phase
import fcc.android.R
import fcc.android.Tick
import kotlin.math.PI
import kotlin.math.roundToInt

/** The values that pilots read: feet, knots and degrees. SI and radians inside. */
internal object Units {
    const val FOOT_M = 0.3048
    const val KNOT_MPS = 1852.0 / 3600.0
    const val DEGREE_RAD = PI / 180.0
}

/** A heading of 1 to 360 degrees. */
internal fun headingDeg(headingRad: Double): Int {
    val degrees = (headingRad / Units.DEGREE_RAD).roundToInt().mod(360)
    return if (degrees == 0) 360 else degrees
}

internal fun Context.heading(rad: Double): String = getString(R.string.degrees, headingDeg(rad))

internal fun Context.feet(m: Double): String = getString(R.string.feet, (m / Units.FOOT_M).roundToInt())

internal fun Context.knots(mps: Double): String = getString(R.string.knots, (mps / Units.KNOT_MPS).roundToInt())

/** A short time in µs or ms, with two digits at least. */
internal fun Context.duration(us: Double): String = when {
    us < 10.0 -> getString(R.string.microseconds_tenths, us)
    us < 1_000.0 -> getString(R.string.microseconds, us.roundToInt())
    else -> getString(R.string.milliseconds, us / 1e3)
}

/** A duration in minutes and seconds. */
internal fun minutes(s: Double): String = s.roundToInt().let { "%d:%02d".format(it / 60, it % 60) }

/** A size, in the larger of kB and MB. */
internal fun bytes(count: Long): String =
    if (count < 1_000_000) "%d kB".format((count + 500) / 1_000) else "%.1f MB".format(count / 1e6)

/** That nothing arrives from what is read; what to do is on the screen *connect*, too. */
internal fun Context.silence(state: FlightState): String =
    getString(R.string.silent, state.sources.joinToString().ifEmpty { getString(R.string.silent_sources) })

/** What a phase is called while no tick is known. */
internal val Phase.words: Int
    get() = when (this) {
        Phase.IDLE -> R.string.phase_idle
        Phase.BEGINNING -> R.string.phase_beginning
        Phase.FLYING -> R.string.phase_flying
        Phase.ENDING -> R.string.phase_ending
    }

/** What the state of the loop is called. */
internal fun words(context: Context, now: Tick): String = when (now.state) {
    "standby" -> context.getString(R.string.state_standby)
    "engaged" -> context.getString(R.string.state_engaged)
    "failsafe" -> context.getString(R.string.state_failsafe)
    "stopped" -> context.getString(R.string.state_stopped)
    else -> now.state
}
