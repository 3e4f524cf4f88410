package fcc.android.app

import android.view.View
import android.widget.Button
import fcc.android.Flight
import fcc.android.R
import fcc.android.XPlanePeer
import fcc.android.screens.MainActivity
import org.junit.After
import org.junit.Assert.assertFalse
import org.junit.Assert.assertTrue
import org.junit.Rule
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.Robolectric
import org.robolectric.RobolectricTestRunner
import org.robolectric.annotation.Config

/** X-Plane over a network that is lost in flight, as in airplane mode, and comes back. */
@RunWith(RobolectricTestRunner::class)
@Config(sdk = [28, 34, 35])
class LostWifiTest {
    @get:Rule
    val phone = Phone()
    private val xPlane = XPlanePeer()
    private val controller by lazy { Robolectric.buildActivity(MainActivity::class.java).setup() }
    private val activity get() = controller.get()

    @After
    fun close() {
        phone.endFlight()
        controller.close()
        xPlane.close()
    }

    /** Waits for a switch that a finger may touch, and touches it. */
    private fun engageOnScreen() {
        val switch = activity.findViewById<Button>(R.id.engage)
        phone.eventually("it may be engaged") { switch.text == "Engage" && switch.isEnabled }
        phone.pass(600)
        activity.touch(R.id.engage)
        phone.eventually("X-Plane's controls are taken") { xPlane.isOverridden }
    }

    /** Moves X-Plane's switch off and on, and leaves it on. */
    private fun engageInXPlane() {
        phone.eventually("it may be engaged") { phone.tick()?.engageInhibits?.isEmpty() == true }
        xPlane.switch(isOn = false)
        phone.pass(1_000)
        xPlane.switch(isOn = true)
        phone.eventually("X-Plane's controls are taken") { xPlane.isOverridden }
    }

    private fun attitudeIs(words: String) = words in activity.findViewById<View>(R.id.attitude).contentDescription

    private fun losesItsControls() {
        phone.eventually("the attitude is shown") { attitudeIs("Roll") }
        phone.eventually("the screen says it") { SILENT in activity.words(R.id.problem) }
        phone.eventually("nothing old is shown as attitude") { attitudeIs("Attitude unknown") }
        phone.eventually("failsafe") { phone.isIn("failsafe") }
        phone.eventually("the notification says it") { phone.notificationWords().startsWith("Failsafe / ") }
        phone.eventually("given back") { phone.isIn("standby") }
        // Of the failsafe that is over the screen may still show its reason.
        phone.eventually("what is missing is said") { MISSING in activity.words(R.id.problem) }
        phone.eventually("and why") { activity.words(R.id.problem).lines().first().startsWith(NOTHING) }
        phone.eventually("the notification says why") { phone.notificationWords().startsWith("Standby / $NOTHING") }
    }

    /** Longer than what a failsafe needs to end by itself, and a release to be confirmed. */
    private fun assertStaysReleased() {
        phone.eventually("released") { !xPlane.isOverridden }
        phone.eventually("it may be engaged") { phone.tick()?.engageInhibits?.isEmpty() == true }
        phone.pass(6_000)
        assertTrue(phone.isIn("standby"))
        assertFalse(xPlane.isOverridden)
    }

    @Test
    fun `of a Wi-Fi that comes back nothing is taken before the screen's switch is used`() {
        phone.start(config(others = "[engage]\ncommand_needs_switch = false\n"))
        engageOnScreen()
        xPlane.isSilent = true
        losesItsControls()
        assertTrue("it has heard nothing of the release", xPlane.isOverridden)
        xPlane.isSilent = false
        assertStaysReleased()
        engageOnScreen()
    }

    @Test
    fun `of a Wi-Fi that comes back nothing is taken before X-Plane's switch is moved`() {
        phone.start(config())
        activity
        engageInXPlane()
        xPlane.isSilent = true
        losesItsControls()
        xPlane.isSilent = false
        assertStaysReleased()
        engageInXPlane()
    }

    @Test
    fun `an X-Plane that ends is said, and nothing of the next one is taken`() {
        phone.start(config(others = "[engage]\ncommand_needs_switch = false\n"))
        engageOnScreen()
        xPlane.close()
        phone.eventually("the screen says it") { SILENT in activity.words(R.id.problem) }
        phone.eventually("given back") { phone.isIn("standby") }
        phone.eventually("the reason is there") {
            Flight.state().reports.any { "no program listens on UDP port" in it }
        }
        xPlane.restart()
        assertStaysReleased()
        engageOnScreen()
    }

    @Test
    fun `before anything arrives the screen says so, and with the first readings it does not`() {
        xPlane.isSilent = true
        phone.start(config(others = "[engage]\ncommand_needs_switch = false\n"))
        phone.eventually("the screen says it") { activity.words(R.id.problem).lines().first().startsWith(NOTHING) }
        phone.eventually("the notification says it") { phone.notificationWords().startsWith("Standby / $NOTHING") }
        xPlane.isSilent = false
        phone.eventually("it is not said any more") { NOTHING !in activity.words(R.id.problem) }
        engageOnScreen()
    }

    private fun config(others: String = "") = """
[x-plane]
simulator = "${xPlane.address}"
[failsafe]
all_silent_s = 2.0
hold_s = 1.0
[guidance]
mode = "hold"
[realtime]
lock_memory = false
$others"""

    private companion object {
        const val SILENT = "nothing arrives from the simulator"

        /** In standby, as long as it is so. */
        const val NOTHING = "Nothing arrives from X-Plane"

        /** In standby, of each reading that is needed. */
        const val MISSING = "is missing or too old"
    }
}
