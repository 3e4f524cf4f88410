package fcc.android

import java.io.File
import org.junit.Assert.assertEquals
import org.junit.Assert.assertNotNull
import org.junit.Assert.assertNull
import org.junit.Assert.assertThrows
import org.junit.Assert.assertTrue
import org.junit.Test

/** Each after what it needs. */
private val KINDS = listOf("accelerometer", "gyroscope", "mounting", "magnetometer")

class CalibrationTest {
    private val byPhone = """
        actuator = []
        [navigation]
        method = "kalman"
        [[sensor]]
        kind = "phone"
        position = false
    """.trimIndent()

    private fun toItsEnd(calibration: Calibration, seconds: Int): CalibrationState {
        val said = mutableListOf<String>()
        repeat(seconds * 20) {
            val state = calibration.state()
            if (said.lastOrNull() != state.next) said += state.next
            if (!state.isRunning) {
                println("${state.kind}: ${said.size} steps, ${state.found ?: state.refused}")
                return state
            }
            Thread.sleep(50)
        }
        throw AssertionError("not within $seconds s: $said, ${calibration.state()}")
    }

    /** It lies still and shows 0.02, -0.01 and 0.005 rad/s, in degrees 1.146, -0.573 and 0.286. */
    @Test
    fun `the gyroscope of the phone is calibrated, and flights use it`() {
        val folder = folder()
        assertEquals(KINDS, Calibration.offered(byPhone, folder).map { it.kind })
        val found = Calibration(byPhone, folder, "gyroscope", "fcc.biased").use { toItsEnd(it, 40).found }
        assertNotNull(found)
        assertEquals(found, Calibration.offered(byPhone, folder).single { it.kind == "gyroscope" }.found)
        val stored = File(folder, "fccd.calibration.toml").readText()
        val numbers = Regex("""bias_degps = \[([^]]*)]""").findAll(stored).last().groupValues[1]
        val bias = numbers.split(",").filter { it.isNotBlank() }.map { it.trim().toDouble() }
        for ((expected, is_) in listOf(1.146, -0.573, 0.286).zip(bias)) assertEquals(expected, is_, 0.001)
        FlightComputer(byPhone, folder, packageName = "fcc.biased").use { computer ->
            val remarks = computer.json().getJSONArray("remarks").join("\n")
            assertTrue(remarks, "gyroscope of " in remarks)
        }
    }

    /** A simulated person holds the built-in aircraft's sensors, which are those of a phone. */
    @Test
    fun `all kinds are guided to their ends, each after what it needs`() {
        val folder = folder()
        val config = "[built-in]\nraw_sensors = \"phone\"\n[navigation]\nmethod = \"kalman\"\n"
        Calibration(config, folder, "magnetometer").use {
            assertTrue("calibrate the accelerometer" in toItsEnd(it, 20).refused!!)
        }
        for (kind in KINDS) {
            Calibration(config, folder, kind).use { assertNull(toItsEnd(it, 200).refused) }
        }
        val found = Calibration.offered(config, folder).filter { it.found != null }.map { it.kind }
        assertEquals(KINDS, found)
    }

    @Test
    fun `one that is given up changes nothing, and another one waits for its file`() {
        val folder = folder()
        Calibration(byPhone, folder, "accelerometer").use { first ->
            eventually("it is guided") { first.state().next.isNotEmpty() }
            Calibration(byPhone, folder, "gyroscope").use { second ->
                assertTrue("another" in toItsEnd(second, 10).refused!!)
            }
        }
        assertTrue(Calibration.offered(byPhone, folder).all { it.found == null })
        eventually("its threads have ended: ${threads()}") {
            threads().none { it.startsWith("phone ") || it == "fcc-calibrate" }
        }
        assertThrows(CalibrationException::class.java) { Calibration(byPhone, folder, "compass") }
        assertThrows(ConfigException::class.java) { Calibration("wrong", folder, "gyroscope") }
    }

    @Test
    fun `a phone without the sensor is told so`() {
        Calibration(byPhone, folder(), "gyroscope", "fcc.without.gyroscope").use {
            assertTrue("no readings of the gyroscope" in toItsEnd(it, 20).refused!!)
        }
    }
}
