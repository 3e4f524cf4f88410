package fcc.android.app

import android.Manifest
import android.graphics.Bitmap
import android.graphics.Canvas
import android.graphics.Rect
import android.view.View
import android.view.ViewGroup
import android.widget.AdapterView
import android.widget.ListView
import android.widget.TextView
import fcc.android.Configuration
import fcc.android.Flight
import fcc.android.R
import fcc.android.screens.MainActivity
import java.io.File
import org.junit.Assert.assertEquals
import org.junit.Assert.assertTrue
import org.junit.Rule
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.Robolectric
import org.robolectric.RobolectricTestRunner
import org.robolectric.RuntimeEnvironment
import org.robolectric.Shadows.shadowOf
import org.robolectric.annotation.Config
import org.robolectric.annotation.GraphicsMode

/**
 * Pictures of each screen, by day and night, small and with large fonts, for a person
 * to look at; and of each, that no text is cut off, and each stands out from what is
 * behind it, and that what can be touched has a name and is large enough.
 */
@RunWith(RobolectricTestRunner::class)
@Config(sdk = [34])
@GraphicsMode(GraphicsMode.Mode.NATIVE)
class PicturesTest {
    @get:Rule
    val phone = Phone()

    @Test
    fun `by day`() = picture("light", "w411dp-h850dp-notnight-xhdpi")

    @Test
    fun `by night`() = picture("dark", "w411dp-h850dp-night-xhdpi")

    @Test
    fun `with large fonts`() = picture("large-font", "w411dp-h850dp-notnight-xhdpi", fontScale = 2f)

    @Test
    fun `on a small screen`() = picture("small", "w320dp-h500dp-notnight-xhdpi")

    @Test
    fun `on a small screen with large fonts`() = picture("small-large-font", "w320dp-h500dp-night-xhdpi", fontScale = 2f)

    @Test
    fun `on its side`() = picture("landscape", "w740dp-h360dp-land-night-xhdpi")

    private fun picture(name: String, qualifiers: String, fontScale: Float = 1f) {
        RuntimeEnvironment.setQualifiers(qualifiers)
        RuntimeEnvironment.setFontScale(fontScale)
        shadowOf(phone.app).grantPermissions(Manifest.permission.POST_NOTIFICATIONS)
        Robolectric.buildActivity(MainActivity::class.java).setup().use { controller ->
            val activity = controller.get()
            fun take(screen: String) {
                phone.pass(200)
                val picture = draw(activity)
                save(picture, "$screen-$name")
                assertNoTextIsCutOff(activity.findViewById(R.id.root))
                assertTextStandsOut(activity.findViewById(R.id.root), picture)
                assertCanBeTouched(activity.findViewById(R.id.root))
            }
            take("idle")
            phone.fly()
            Flight.engage()
            Flight.set("heading_rad", Math.toRadians(60.0))
            // Rolled and yawing.
            phone.pass(1_500)
            take("fly")
            activity.open(MainActivity.CONNECT)
            take("connect")
            phone.endFlight()
            activity.open(MainActivity.RECORDINGS)
            val list = activity.findViewById<ListView>(R.id.list)
            phone.eventually("listed") { list.adapter.count > 0 }
            take("recordings")
            list.performItemClick(null, 0, 0)
            val details = activity.findViewById<View>(R.id.details)
            phone.eventually("reported") { details.allWords().any { "Lateness" in it } }
            take("recording")
            activity.touch(R.id.delete)
            phone.eventually("deleted") { activity.findViewById<View>(R.id.undo).isShown }
            take("deleted")
            activity.open(MainActivity.SETTINGS)
            activity.findViewById<TextView>(R.id.text).text = "[built-in]\n\n[loop]\nrate_hz = -1  # Hz\n"
            activity.touch(R.id.check)
            phone.eventually("checked") { "rate_hz" in activity.words(R.id.message) }
            take("settings")
            Configuration(phone.app).save(BY_PHONE)
            activity.open(MainActivity.CONNECT)
            phone.beginCalibration(activity, "accelerometer")
            val next = activity.findViewById<TextView>(R.id.calibration_next)
            phone.eventually("what to do") { "up" in next.text }
            val card = activity.findViewById<View>(R.id.calibration_guide)
            card.requestRectangleOnScreen(Rect(0, 0, card.width, card.height), true)
            take("calibration")
        }
    }

    private fun draw(activity: MainActivity): Bitmap {
        val root = activity.window.decorView
        return Bitmap.createBitmap(root.width, root.height, Bitmap.Config.ARGB_8888).also { root.draw(Canvas(it)) }
    }

    private fun save(picture: Bitmap, name: String) {
        val file = File(System.getProperty("pictures"), "$name.png")
        file.parentFile!!.mkdirs()
        file.outputStream().use { assertTrue(picture.compress(Bitmap.CompressFormat.PNG, 0, it)) }
    }

    /** Text that has less room than it needs, or of which an end is left out. */
    private fun assertNoTextIsCutOff(view: View) {
        if (view is ViewGroup) (0 until view.childCount).forEach { assertNoTextIsCutOff(view.getChildAt(it)) }
        if (view !is TextView || !view.isShown || view.text.isEmpty() || view.id == R.id.text) return
        val layout = view.layout ?: return
        val room = view.height - view.compoundPaddingTop - view.compoundPaddingBottom
        assertTrue("${view.text}: ${layout.height} in $room", layout.height <= room)
        (0 until layout.lineCount).forEach { line ->
            assertEquals("${view.text}", 0, layout.getEllipsisCount(line))
            val wide = layout.getLineMax(line) - 1
            val wideRoom = view.width - view.compoundPaddingLeft - view.compoundPaddingRight
            assertTrue("${view.text}: $wide wide in $wideRoom", wide <= wideRoom)
        }
        // Lines that are beyond the last one permitted are in no layout.
        assertEquals("${view.text}", view.text.length, layout.getLineEnd(layout.lineCount - 1))
    }

    /** What a finger may touch has a name for screen readers, and the size of a finger's tip. */
    private fun assertCanBeTouched(view: View) {
        if (view is ViewGroup) (0 until view.childCount).forEach { assertCanBeTouched(view.getChildAt(it)) }
        // Of a list each row is touched.
        val isTouched = if (view is AdapterView<*>) false else view.isClickable || view.parent is AdapterView<*>
        if (!view.isShown || !isTouched) return
        val name = view.contentDescription?.toString() ?: view.allWords().joinToString(" ")
        assertTrue("no name: $view", name.isNotBlank())
        // Signs are read as words, or not at all.
        assertTrue("no word: $name", name.any { it.isLetter() })
        val least = FINGER_DP * view.resources.displayMetrics.density
        assertTrue("$name: ${view.width} x ${view.height} of $least", minOf(view.width, view.height) >= least)
    }

    /** Each text, also of a button that is disabled, from the most frequent colour around it. */
    private fun assertTextStandsOut(view: View, picture: Bitmap) {
        if (view is ViewGroup) (0 until view.childCount).forEach { assertTextStandsOut(view.getChildAt(it), picture) }
        val area = Rect()
        val isDrawn = view is TextView && view.isShown && view.text.isNotEmpty() && view.getGlobalVisibleRect(area)
        if (!isDrawn) return
        val pixels = IntArray(area.width() * area.height())
        picture.getPixels(pixels, 0, area.width(), area.left, area.top, area.width(), area.height())
        val counts = HashMap<Int, Int>()
        pixels.forEach { counts.merge(it, 1, Int::plus) }
        val contrast = contrast((view as TextView).currentTextColor, counts.maxBy { it.value }.key)
        assertTrue("${view.text}: $contrast", contrast >= LEAST_CONTRAST)
    }

    private companion object {
        /** Android's *Accessibility*: touch targets. */
        const val FINGER_DP = 48
    }
}
