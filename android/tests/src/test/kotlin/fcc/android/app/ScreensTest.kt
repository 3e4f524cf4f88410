package fcc.android.app

import android.content.Intent
import android.net.Uri
import android.view.View
import android.widget.Button
import android.widget.EditText
import android.widget.ListView
import android.widget.TextView
import fcc.android.Configuration
import fcc.android.Flight
import fcc.android.Phase
import fcc.android.R
import fcc.android.RecordingEntry
import fcc.android.Recordings
import fcc.android.screens.MainActivity
import java.io.FileNotFoundException
import java.util.concurrent.atomic.AtomicBoolean
import kotlin.concurrent.thread
import org.json.JSONObject
import org.junit.After
import org.junit.Assert.assertEquals
import org.junit.Assert.assertFalse
import org.junit.Assert.assertThrows
import org.junit.Assert.assertTrue
import org.junit.Rule
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.Robolectric
import org.robolectric.RobolectricTestRunner
import org.robolectric.Shadows.shadowOf
import org.robolectric.annotation.Config

@RunWith(RobolectricTestRunner::class)
@Config(sdk = [28, 34, 35])
class ScreensTest {
    @get:Rule
    val phone = Phone()
    private val controller by lazy {
        shadowOf(phone.app).grantPermissions(android.Manifest.permission.POST_NOTIFICATIONS)
        Robolectric.buildActivity(MainActivity::class.java).setup()
    }
    private val activity get() = controller.get()

    @After
    fun close() {
        controller.close()
    }

    private fun switchSays(words: String) {
        val switch = activity.findViewById<Button>(R.id.engage)
        phone.eventually("the switch says $words") { switch.text.toString() == words && switch.isEnabled }
        // Before that a second finger would be taken for a hasty one.
        phone.pass(600)
        assertEquals(words, switch.text.toString())
    }

    @Test
    fun `the switch starts, engages and disengages`() {
        switchSays("Start")
        activity.touch(R.id.engage)
        switchSays("Engage")
        assertEquals("Standby", activity.words(R.id.state))
        activity.touch(R.id.engage)
        switchSays("Disengage")
        assertEquals("Engaged", activity.words(R.id.state))
        assertEquals("Mode: hold", activity.words(R.id.mode))
        assertFalse("no flight ends by a wrong touch", activity.findViewById<View>(R.id.end_flight).isEnabled)
        activity.touch(R.id.engage)
        switchSays("Engage")
        assertTrue(phone.isIn("standby"))
        activity.touch(R.id.end_flight)
        switchSays("Start")
        assertEquals("whole", phone.recordings.list().single().wholeness)
    }

    @Test
    fun `a hasty second touch does not undo the first`() {
        phone.fly()
        switchSays("Engage")
        val switch = activity.findViewById<Button>(R.id.engage)
        repeat(20) {
            switch.performClick()
            phone.pass(10)
        }
        phone.eventually("engaged") { phone.isIn("engaged") }
        phone.pass(600)
        repeat(20) {
            switch.performClick()
            phone.pass(10)
        }
        phone.eventually("in standby") { phone.isIn("standby") }
    }

    @Test
    fun `set points are changed by steps in pilots' units`() {
        phone.fly()
        Flight.engage()
        Flight.set("heading_rad", Math.toRadians(88.0))
        Flight.set("altitude_m", 3_004 * 0.3048)
        fun row(id: Int) = activity.findViewById<View>(id)
        fun setPoint(id: Int) = row(id).findViewById<TextView>(R.id.set_point).text.toString()
        phone.eventually("they are shown") { setPoint(R.id.heading) == "set 088°" && setPoint(R.id.altitude) == "set 3,004 ft" }
        repeat(3) { row(R.id.heading).findViewById<View>(R.id.more).performClick() }
        row(R.id.altitude).findViewById<View>(R.id.less).performClick()
        phone.eventually("the loop has them") {
            val desired = phone.tick()!!.desired!!
            Math.abs(Math.toDegrees(desired.headingRad) - 105.0) < 1e-6 &&
                Math.abs(desired.altitudeM / 0.3048 - 2_950.0) < 1e-6
        }
        phone.pass(1_500)
        assertEquals("set 105°", setPoint(R.id.heading))
        assertEquals("set 2,950 ft", setPoint(R.id.altitude))
        assertEquals("Heading: 005° more", row(R.id.heading).findViewById<View>(R.id.more).contentDescription)
    }

    @Test
    fun `a step that is refused is said, and not shown`() {
        phone.fly()
        Flight.engage()
        phone.eventually("engaged") { phone.isIn("engaged") }
        phone.eventually("shown") { activity.words(R.id.state) == "Engaged" }
        val less = activity.findViewById<View>(R.id.airspeed).findViewById<View>(R.id.less)
        repeat(100) { less.performClick() }
        phone.eventually("the reason") { "airspeed" in activity.words(R.id.problem) }
    }

    @Test
    fun `of two thousand quick touches nothing is left to be done later`() {
        phone.fly()
        Flight.engage()
        phone.eventually("shown") { activity.words(R.id.state) == "Engaged" }
        val row = activity.findViewById<View>(R.id.heading)
        repeat(2_000) { row.findViewById<View>(R.id.more).performClick() }
        // Of 5 degrees each: 27 times around, and 280 degrees.
        val asked = row.findViewById<TextView>(R.id.set_point)
        phone.pass(1_500)
        val settled = phone.tick()!!.desired!!.headingRad
        phone.pass(1_000)
        assertEquals(settled, phone.tick()!!.desired!!.headingRad, 0.0)
        assertEquals("set %03.0f°".format(Math.toDegrees(settled)), asked.text.toString())
        phone.pass(600)
        repeat(2_000) { activity.touch(R.id.engage) }
        phone.eventually("in standby") { phone.isIn("standby") }
        switchSays("Engage")
        activity.touch(R.id.engage)
        switchSays("Disengage")
        phone.pass(1_000)
        assertTrue("it stays engaged", phone.isIn("engaged"))
    }

    @Test
    fun `it flies without the permissions that are refused, and says what is missing`() {
        val shadow = shadowOf(phone.app)
        shadow.denyPermissions("android.permission.POST_NOTIFICATIONS", "android.permission.ACCESS_FINE_LOCATION")
        Configuration(phone.app).save(BY_PHONE)
        val refusing = Robolectric.buildActivity(MainActivity::class.java).setup().get()
        phone.pass(600)
        refusing.touch(R.id.engage)
        val wanted = shadowOf(refusing).lastRequestedPermission.requestedPermissions
        assertTrue("android.permission.ACCESS_FINE_LOCATION" in wanted)
        assertEquals(Phase.IDLE, Flight.phase)
        refusing.onRequestPermissionsResult(
            shadowOf(refusing).lastRequestedPermission.requestCode, wanted, IntArray(wanted.size) { -1 },
        )
        phone.eventually("it flies") { Flight.phase == Phase.FLYING }
        refusing.open(MainActivity.CONNECT)
        assertTrue(refusing.findViewById<View>(R.id.permissions).allWords().any { it.startsWith("Location is not permitted") })
    }

    /** Android 9 has another way to write a file at once. */
    @Config(sdk = [34, 35])
    @Test
    fun `a configuration that is damaged, and no room for another one, are said`() {
        val file = phone.app.filesDir.resolve("fccd.toml")
        file.writeBytes(ByteArray(5_000) { it.toByte() })
        switchSays("Start")
        activity.touch(R.id.engage)
        phone.eventually("why") { "configuration:1" in activity.words(R.id.problem) }
        assertEquals(Phase.IDLE, Flight.phase)
        activity.open(MainActivity.SETTINGS)
        // As on a disk that is full.
        file.delete()
        phone.app.filesDir.resolve("fccd.toml.new").mkdirs()
        phone.app.filesDir.resolve("fccd.toml.new/a").mkdirs()
        activity.touch(R.id.example_built_in)
        activity.touch(R.id.save)
        phone.eventually("why") { activity.words(R.id.message).startsWith("Cannot be saved: ") }
        phone.app.filesDir.resolve("fccd.toml.new").deleteRecursively()
    }

    @Test
    fun `an activity that is made anew keeps the flight, the screen and the unsaved text`() {
        phone.fly()
        Flight.engage()
        val before = phone.tick()!!.timeS
        activity.open(MainActivity.SETTINGS)
        activity.findViewById<EditText>(R.id.text).setText("not saved")
        controller.recreate()
        assertEquals("not saved", activity.findViewById<EditText>(R.id.text).text.toString())
        assertTrue(activity.findViewById<View>(R.id.text).isShown)
        activity.open(MainActivity.FLY)
        phone.eventually("it shows the flight") { activity.words(R.id.state) == "Engaged" }
        assertTrue(phone.tick()!!.timeS > before)
        assertEquals(1, phone.recordings.list().size)
    }

    @Test
    fun `what is being saved while the activity is made anew counts as saved`() {
        activity.open(MainActivity.SETTINGS)
        val text = "[built-in]\n[loop]\nrate_hz = 50\n"
        val field = activity.findViewById<EditText>(R.id.text)
        // It takes a second to say what is wrong with each of its lines.
        field.setText((0..8_000).joinToString("\n", "[built-in]\n") { "k$it = 1" })
        activity.touch(R.id.check)
        field.setText(text)
        activity.touch(R.id.save)
        controller.recreate()
        phone.eventually("saved") { Configuration(phone.app).text() == text }
        phone.eventually("it is the saved one") { activity.words(R.id.message).startsWith("This is the saved") }
        assertFalse(activity.findViewById<View>(R.id.discard).isEnabled)
    }

    /** As a service, a calibration and another activity do. */
    @Test
    fun `a configuration that is read while it is saved is saved`() {
        val isOver = AtomicBoolean()
        val reader = thread {
            while (!isOver.get()) Configuration(phone.app).text()
        }
        try {
            repeat(500) {
                Configuration(phone.app).save("# $it\n$FLOWN")
                assertEquals("# $it\n$FLOWN", Configuration(phone.app).text())
            }
        } finally {
            isOver.set(true)
            reader.join()
        }
    }

    @Test
    fun `a configuration that cannot be flown is refused with the line, and not saved`() {
        activity.open(MainActivity.SETTINGS)
        val text = activity.findViewById<EditText>(R.id.text)
        text.setText("[built-in]\n[loop]\nrate_hz = -1\n")
        activity.touch(R.id.save)
        phone.eventually("the message") { "configuration:3: loop.rate_hz" in activity.words(R.id.message) }
        assertEquals("rate_hz = -1", text.text.substring(text.selectionStart, text.selectionEnd))
        assertEquals(FLOWN, Configuration(phone.app).text())
        text.setText("[built-in]\n[loop]\nrate_hz = 50\n")
        assertEquals("Not saved.", activity.words(R.id.message))
        activity.touch(R.id.save)
        phone.eventually("saved") { activity.words(R.id.message) == "Valid, and saved." }
        assertEquals("[built-in]\n[loop]\nrate_hz = 50\n", Configuration(phone.app).text())
    }

    @Test
    fun `every example can be flown`() {
        activity.open(MainActivity.SETTINGS)
        for (example in listOf(R.id.example_built_in, R.id.example_x_plane, R.id.example_phone)) {
            activity.touch(example)
            activity.touch(R.id.check)
            phone.eventually("valid") { activity.words(R.id.message) == "Valid, and not saved." }
        }
        assertTrue(Configuration.usesPhone(activity.words(R.id.text)))
    }

    private fun fliesOnce() {
        phone.fly()
        phone.pass(300)
        phone.endFlight()
    }

    private fun openFirst(): ListView {
        activity.open(MainActivity.RECORDINGS)
        val list = activity.findViewById<ListView>(R.id.list)
        phone.eventually("listed") { list.adapter.count > 0 }
        list.performItemClick(null, 0, 0)
        return list
    }

    @Test
    fun `a recording is shown with its timing, and shared to be read only`() {
        fliesOnce()
        openFirst()
        val details = activity.findViewById<View>(R.id.details)
        phone.eventually("the timing") { "Lateness, p50 and p99" in details.allWords() }
        assertTrue("40 Hz, timerfd" in details.allWords())
        assertTrue(details.allWords().any { it.startsWith("Every tick from 1 to") })

        activity.touch(R.id.share)
        val shared = shadowOf(activity).nextStartedActivity.getParcelableExtra<Intent>(Intent.EXTRA_INTENT)!!
        val uri = shared.getParcelableExtra<Uri>(Intent.EXTRA_STREAM)!!
        val file = phone.recordings.list().single().file
        val resolver = phone.app.contentResolver
        assertEquals(file.readBytes().toList(), resolver.openInputStream(uri)!!.use { it.readBytes().toList() })
        resolver.query(uri, null, null, null, null)!!.use {
            assertTrue(it.moveToFirst())
            assertEquals(listOf(file.name, "${file.length()}"), listOf(it.getString(0), it.getString(1)))
        }
        assertTrue(shared.flags and Intent.FLAG_GRANT_READ_URI_PERMISSION != 0)
        assertThrows(FileNotFoundException::class.java) { resolver.openFileDescriptor(uri, "rw") }
        for (other in listOf("..%2Ffccd.toml", "..%2F..%2Ffccd.toml", "deleted", "a/b.mcap", "")) {
            val wrong = Uri.parse("content://fcc.android.recordings/$other")
            assertThrows(other, FileNotFoundException::class.java) { resolver.openFileDescriptor(wrong, "r") }
        }
    }

    @Test
    fun `a recording is deleted, and restored while the screen is there`() {
        fliesOnce()
        val list = openFirst()
        val file = phone.recordings.list().single().file
        activity.touch(R.id.delete)
        phone.eventually("deleted") { !file.exists() && list.adapter.count == 0 }
        controller.recreate()
        assertTrue("Undo is there", activity.findViewById<View>(R.id.undo).isShown)
        activity.touch(R.id.undo)
        phone.eventually("restored") { file.exists() }
        assertEquals("whole", phone.recordings.list().single().wholeness)

        openFirst()
        activity.touch(R.id.delete)
        phone.eventually("deleted") { !file.exists() }
        activity.open(MainActivity.FLY)
        phone.eventually("gone for good") { file.parentFile!!.list()!!.isEmpty() }
    }

    /** As from a list that was read before the flight wrote to it. */
    @Test
    fun `what a flight writes is not deleted, whatever the list says`() {
        phone.fly()
        val file = phone.recordings.fileOf(Recordings.folder(phone.app).list()!!.single { it.endsWith(".mcap") })
        assertFalse(phone.recordings.delete(file))
        assertTrue(file.exists())
        phone.endFlight()
        assertEquals(1, phone.recordings.list().single { it.wholeness == "whole" }.part)
        assertTrue(phone.recordings.delete(file))
        assertTrue(phone.recordings.restore(file))
        assertTrue(RecordingEntry(JSONObject("""{"path": "a", "error": "a: still being written, 8 bytes so far"}""")).isBeingWritten)
    }

    @Test
    fun `the recording of the flight that goes on is neither shared nor deleted`() {
        phone.fly()
        phone.eventually("it is there") { phone.recordings.list().any { it.isBeingWritten } }
        openFirst()
        assertFalse(activity.findViewById<View>(R.id.delete).isEnabled)
        assertFalse(activity.findViewById<View>(R.id.share).isEnabled)
    }
}
