package fcc.android.app

import android.graphics.Color
import fcc.android.R
import org.junit.Assert.assertEquals
import org.junit.Assert.assertTrue
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.RobolectricTestRunner
import org.robolectric.RuntimeEnvironment
import org.robolectric.annotation.Config

/** Of text to what is behind it: WCAG 2.1, success criterion 1.4.3. */
const val LEAST_CONTRAST = 4.5

/** The contrast ratio of two opaque colours, 1 to 21: WCAG 2.1, "contrast ratio". */
fun contrast(one: Int, other: Int): Double {
    val (darker, lighter) = listOf(one, other).map { Color.luminance(it).toDouble() }.sorted()
    return (lighter + 0.05) / (darker + 0.05)
}

/** The colours of the attitude indicator; those of texts are checked where they are drawn. */
@RunWith(RobolectricTestRunner::class)
@Config(sdk = [34])
class ContrastTest {
    /** Black on white, and the darkest grey that fails and the lightest that passes on white (WebAIM). */
    @Test
    fun `the ratio is that of the published examples`() {
        assertEquals(21.0, contrast(Color.BLACK, Color.WHITE), 1e-6)
        assertEquals(4.48, contrast(Color.parseColor("#777777"), Color.WHITE), 0.005)
        assertEquals(4.54, contrast(Color.WHITE, Color.parseColor("#767676")), 0.005)
    }

    @Test
    fun `by day`() = assertLinesStandOut("notnight")

    @Test
    fun `by night`() = assertLinesStandOut("night")

    private fun assertLinesStandOut(qualifier: String) {
        RuntimeEnvironment.setQualifiers("+$qualifier")
        val app = RuntimeEnvironment.getApplication()
        val drawn = listOf(
            R.color.instrument_line to R.color.sky,
            R.color.instrument_line to R.color.ground,
            R.color.instrument_aircraft to R.color.sky,
            R.color.instrument_aircraft to R.color.ground,
            R.color.bad to R.color.instrument_unknown,
        )
        for ((line, behind) in drawn) {
            val contrast = contrast(app.getColor(line), app.getColor(behind))
            val names = listOf(line, behind).map(app.resources::getResourceEntryName)
            assertTrue("$names: $contrast", contrast >= LEAST_CONTRAST)
        }
    }
}
