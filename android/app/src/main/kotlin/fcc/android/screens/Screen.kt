package fcc.android.screens

import android.os.Bundle
import android.view.View
import fcc.android.FlightState

/** One of the app's four screens: a view, and what fills it. */
interface Screen {
    val view: View

    /** Shows a state of the flight; in the thread that draws. */
    fun show(state: FlightState)

    /** It is in front now. */
    fun enter() = Unit

    /** Another one is, or the app is left. */
    fun leave() = Unit

    /** Whether it has done something with the user's step back. */
    fun back(): Boolean = false

    /** Keeps what the user has not saved, while the activity is made anew. */
    fun save(state: Bundle) = Unit

    /** Restores it. */
    fun restore(state: Bundle) = Unit
}
