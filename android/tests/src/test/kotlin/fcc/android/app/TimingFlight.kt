package fcc.android.app

import android.Manifest
import android.graphics.Bitmap
import android.graphics.Canvas
import fcc.android.screens.MainActivity
import java.io.File
import java.util.concurrent.atomic.AtomicBoolean
import kotlin.concurrent.thread
import org.junit.Assert.assertEquals
import org.junit.Rule
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.Robolectric
import org.robolectric.RobolectricTestRunner
import org.robolectric.Shadows.shadowOf
import org.robolectric.annotation.Config
import org.robolectric.annotation.GraphicsMode

/**
 * A flight whose timing is measured, while the screen *fly* is drawn 20 times a second
 * and garbage is made and collected: no test, for `make bench-android`, which gives the
 * configuration, the seconds and where the recording goes.
 */
@RunWith(RobolectricTestRunner::class)
@Config(sdk = [34], qualifiers = "w411dp-h850dp-notnight-xhdpi")
@GraphicsMode(GraphicsMode.Mode.NATIVE)
class TimingFlight {
    @get:Rule
    val phone = Phone()

    @Test
    fun fly() {
        val config = File(System.getProperty("timing.config")).readText()
        val seconds = System.getProperty("timing.seconds").toDouble()
        val recording = File(System.getProperty("timing.recording"))
        shadowOf(phone.app).grantPermissions(Manifest.permission.POST_NOTIFICATIONS)
        val isOver = AtomicBoolean()
        val litter = thread(name = "garbage") { makeGarbage(isOver) }
        Robolectric.buildActivity(MainActivity::class.java).setup().use { controller ->
            phone.fly(config)
            draw(controller.get(), seconds)
            phone.endFlight()
        }
        isOver.set(true)
        litter.join()
        val flown = phone.recordings.list().single()
        assertEquals("whole", flown.wholeness)
        flown.file.copyTo(recording, overwrite = true)
    }

    private fun draw(activity: MainActivity, seconds: Double) {
        val root = activity.window.decorView
        val canvas = Canvas(Bitmap.createBitmap(root.width, root.height, Bitmap.Config.ARGB_8888))
        val end = System.nanoTime() + (seconds * 1e9).toLong()
        while (System.nanoTime() < end) {
            phone.pass(DRAWN_EVERY_MS)
            root.draw(canvas)
        }
    }

    /** About 50 MB a second, of which the last is kept for a while, and a full collection each second. */
    private fun makeGarbage(isOver: AtomicBoolean) {
        val kept = arrayOfNulls<ByteArray>(KEPT)
        var made = 0
        while (!isOver.get()) {
            repeat(PIECES) { kept[made++ % KEPT] = ByteArray(PIECE_BYTES) }
            if (made % (PIECES * 1_000 / MADE_EVERY_MS.toInt()) == 0) System.gc()
            Thread.sleep(MADE_EVERY_MS)
        }
    }

    private companion object {
        const val DRAWN_EVERY_MS = 50L
        const val MADE_EVERY_MS = 10L
        const val PIECE_BYTES = 10_000
        const val PIECES = 50
        const val KEPT = 2_000
    }
}
