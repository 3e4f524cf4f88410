package fcc.android.app

import android.content.pm.ActivityInfo
import android.view.View
import android.widget.ProgressBar
import fcc.android.Calibration
import fcc.android.Calibrations
import fcc.android.Configuration
import fcc.android.R
import fcc.android.Recordings
import fcc.android.screens.MainActivity
import org.junit.After
import org.junit.Assert.assertEquals
import org.junit.Assert.assertTrue
import org.junit.Rule
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.Robolectric
import org.robolectric.RobolectricTestRunner
import org.robolectric.annotation.Config

/** The phone is that of the fake libandroid: it lies still on its back. */
@RunWith(RobolectricTestRunner::class)
@Config(sdk = [28, 34, 35])
class CalibrationCardTest {
    @get:Rule
    val phone = Phone()
    private val controller by lazy { Robolectric.buildActivity(MainActivity::class.java).setup() }
    private val activity get() = controller.get()

    @After
    fun close() {
        controller.close()
        Calibrations.end()
    }

    private fun view(id: Int) = activity.findViewById<View>(id)

    private fun offers() = view(R.id.calibrations).allWords()

    private fun begin(kind: String) = phone.beginCalibration(activity, kind)

    private fun next() = activity.words(R.id.calibration_next)

    @Test
    fun `a gyroscope is calibrated, while the phone is turned, too`() {
        Configuration(phone.app).save(BY_PHONE)
        activity.open(MainActivity.CONNECT)
        begin("gyroscope")
        phone.eventually("what to do") { next() == "Leave it alone" }
        assertEquals(ActivityInfo.SCREEN_ORIENTATION_LOCKED, activity.requestedOrientation)
        assertEquals(emptyList<String>(), offers())
        val bar = view(R.id.calibration_progress) as ProgressBar
        phone.eventually("some of it") { bar.progress > 300 }
        controller.recreate()
        phone.eventually("it goes on") { (view(R.id.calibration_progress) as ProgressBar).progress > 400 }
        phone.eventually("done") { next().startsWith("Done, and used from now on: gyroscope") }
        phone.eventually("it may turn again") {
            activity.requestedOrientation == ActivityInfo.SCREEN_ORIENTATION_UNSPECIFIED
        }
        phone.eventually("listed") { view(R.id.calibrations_found).allWords().any { it.startsWith("gyroscope of ") } }
        activity.touch(R.id.calibration_cancel)
        phone.eventually("closed") { !view(R.id.calibration_guide).isShown }
    }

    @Test
    fun `one that goes on ends with the screen, and with a flight`() {
        Configuration(phone.app).save(BY_PHONE)
        activity.open(MainActivity.CONNECT)
        begin("accelerometer")
        phone.eventually("what to do") { "is up" in next() || "up, and let go" in next() }
        assertTrue(view(R.id.calibration_details).allWords().any { it.startsWith("Not yet: ") })
        activity.open(MainActivity.FLY)
        activity.open(MainActivity.CONNECT)
        phone.eventually("given up") { !view(R.id.calibration_guide).isShown && offers().isNotEmpty() }
        begin("accelerometer")
        phone.fly()
        phone.eventually("given up") { !view(R.id.calibration_guide).isShown && offers().isEmpty() }
        assertTrue(Calibration.offered(BY_PHONE, Recordings.folder(phone.app)).all { it.found == null })
    }

    @Test
    fun `a configuration without such sensors offers none, and a wrong one says why`() {
        activity.open(MainActivity.CONNECT)
        val found = view(R.id.calibrations_found)
        phone.eventually("none") { "The configuration has no sensors to calibrate." in found.allWords() }
        Configuration(phone.app).save("[built-in]\n[loop]\nrate_hz = -1\n")
        activity.open(MainActivity.FLY)
        activity.open(MainActivity.CONNECT)
        phone.eventually("why") { found.allWords().any { "loop.rate_hz" in it } }
    }
}
