package fcc.android.app

import android.view.View
import android.widget.ListView
import fcc.android.Flight
import fcc.android.R
import fcc.android.Recordings
import fcc.android.screens.MainActivity
import org.junit.After
import org.junit.Assert.assertEquals
import org.junit.Assert.assertTrue
import org.junit.Assume.assumeTrue
import org.junit.Rule
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.Robolectric
import org.robolectric.RobolectricTestRunner
import org.robolectric.annotation.Config

/** The disk of the recordings becomes full in flight. */
@RunWith(RobolectricTestRunner::class)
@Config(sdk = [28, 34, 35])
class FullDiskTest {
    @get:Rule
    val phone = Phone()
    private val controller by lazy { Robolectric.buildActivity(MainActivity::class.java).setup() }
    private val activity get() = controller.get()

    @After
    fun close() {
        controller.close()
    }

    private fun run(vararg words: String): Boolean = ProcessBuilder(*words).inheritIO().start().waitFor() == 0

    /** A write beyond so many bytes of a file fails in this process (setrlimit(2), RLIMIT_FSIZE). */
    private fun limitFiles(bytes: String) {
        assertTrue(run("prlimit", "--pid", "${ProcessHandle.current().pid()}", "--fsize=$bytes:"))
    }

    private fun recordingSays() =
        activity.findViewById<View>(R.id.flown).allWords().find { it.startsWith("Recording") }.orEmpty()

    /** Asserts that the screen says that nothing is recorded, and that the flight goes on and obeys. */
    private fun assertFliesUnrecorded() {
        activity.open(MainActivity.CONNECT)
        phone.eventually("it says so") { recordingSays().startsWith("Recording stopped: ") }
        assertTrue(recordingSays(), "all earlier ones are recorded" in recordingSays())
        val since = phone.tick()!!.timeS
        Flight.set("heading_rad", 1.0)
        phone.eventually("it flies on") {
            val now = phone.tick()!!
            now.timeS > since + 1.0 && Math.abs(now.desired!!.headingRad - 1.0) < 1e-9
        }
        assertTrue(phone.isIn("engaged"))
    }

    @Test
    fun `the recording stops, the flight goes on, and what was recorded opens`() {
        phone.fly(FAST)
        Flight.engage()
        val file = phone.recordings.list().single().file
        // Two seconds.
        val most = file.length() + 200_000
        limitFiles("$most")
        try {
            assertFliesUnrecorded()
            phone.endFlight()
        } finally {
            limitFiles("unlimited")
        }
        assertTrue("${file.length()}", file.length() <= most)
        val report = phone.recordings.report(file)
        assertTrue(report.timing!!.ticks > 100)
        assertTrue(report.events.any { "standby → engaged" in it })
    }

    /** The disk has room for two files, and none for a folder. */
    @Test
    fun `a recording that is deleted makes room for the rest of the flight`() {
        val folder = Recordings.folder(phone.app)
        folder.mkdirs()
        val mount = arrayOf("mount", "-t", "tmpfs", "-o", "size=1m,nr_inodes=3", "none", folder.path)
        assumeTrue("only root may mount a small disk", run(*mount))
        try {
            // Half of it.
            folder.resolve("2020-01-01T00-00-00.000Z-built-in-01.mcap").writeBytes(ByteArray(500_000))
            phone.fly(FAST)
            Flight.engage()
            assertFliesUnrecorded()
            activity.open(MainActivity.RECORDINGS)
            val list = activity.findViewById<ListView>(R.id.list)
            phone.eventually("listed") { list.adapter.count == 2 }
            list.performItemClick(null, 1, 1)
            activity.touch(R.id.delete)
            phone.eventually("deleted") { list.adapter.count == 1 }
            activity.open(MainActivity.FLY)
            phone.eventually("it is recorded again") { Flight.state().reports.any { "recording continues in" in it } }
            assertTrue(phone.isIn("engaged"))
            phone.endFlight()
            val parts = phone.recordings.list().map { it.part }
            assertEquals(listOf(2, 1), parts)
        } finally {
            assertTrue(run("umount", "--lazy", folder.path))
        }
    }

    private companion object {
        /** 110 kB a second (docs/recordings.md). */
        const val FAST = "$FLOWN[loop]\nrate_hz = 200\n[recording]\ncompression = \"none\"\n"
    }
}
