package fcc.android

import org.json.JSONObject
import org.junit.Assert.assertEquals
import org.junit.Assert.assertThrows
import org.junit.Assert.assertTrue
import org.junit.Test

/**
 * The phone's sensors, which the fake libandroid plays: each package is another phone
 * (src/test/resources/phones.jsonl).
 */
class PhoneTest {
    private val byPhone = """
        actuator = []
        [navigation]
        method = "kalman"
        magnetic_field_ut = [21.1, 0.0, 45.3]
        [engage]
        command_needs_switch = false
        [[sensor]]
        kind = "phone"
        position = false
        calibration.accelerometer.mounting = "left-forward-down"
        calibration.gyroscope.mounting = "left-forward-down"
        calibration.magnetometer.mounting = "left-forward-down"
    """.trimIndent()

    private fun sensors(computer: FlightComputer): Map<String, JSONObject> =
        computer.json().getJSONArray("sensors").objects().associateBy { it.getString("kind") }

    @Test
    fun `its sensors are read, and shown with their rates and clocks`() {
        FlightComputer(byPhone, folder()).use { computer ->
            computer.start()
            eventually("all have a rate") {
                val all = sensors(computer).values
                all.size == 4 && all.none { it.isNull("measured_hz") }
            }
            val gyroscope = sensors(computer).getValue("gyroscope")
            assertEquals("fcc.android of type 16", gyroscope.getString("name"))
            assertTrue(gyroscope.getBoolean("is_uncalibrated"))
            assertEquals(100.0, gyroscope.getDouble("asked_hz"), 0.0)
            assertTrue(gyroscope.getDouble("measured_hz") in 95.0..105.0)
            assertTrue(gyroscope.isNull("trouble"))
            assertEquals(25.0, sensors(computer).getValue("barometer").getDouble("asked_hz"), 0.0)
            // On its back, its top to the north: under the fuselage that is upside down.
            eventually("attitude is known") { computer.now()?.isNull("roll_rad") == false }
            assertEquals(Math.PI, Math.abs(computer.now()!!.getDouble("roll_rad")), 0.1)
        }
    }

    @Test
    fun `what the phone lacks inhibits engaging, with the reason`() {
        val heard = Heard()
        FlightComputer(byPhone, folder(), heard, "fcc.without.gyroscope").use { computer ->
            computer.start()
            eventually("the reason is shown") {
                sensors(computer)["gyroscope"]?.optString("trouble") == "phone gyroscope: this phone has none"
            }
            eventually("the reason is reported") { heard.reports.any { "this phone has none" in it } }
            eventually("the accelerometer is read") { !sensors(computer).getValue("accelerometer").isNull("age_ms") }
            assertTrue(computer.now()!!.getJSONArray("engage_inhibits").length() > 0)
            assertThrows(CommandException::class.java) { computer.engage() }
            assertTrue(computer.now()!!.isNull("roll_rad"))
        }
    }

    /** The largest number of 32 bits, which no attitude recovers from for a minute and more. */
    @Test
    fun `values that no sensor can measure are not used, with the reason`() {
        FlightComputer(byPhone, folder(), null, "fcc.beyond.measure").use { computer ->
            computer.start()
            eventually("the reason is shown") {
                "no such sensor can measure" in sensors(computer)["accelerometer"]?.optString("trouble").orEmpty()
            }
            eventually("the gyroscope is read") { !sensors(computer).getValue("gyroscope").isNull("age_ms") }
            assertTrue(computer.now()!!.isNull("roll_rad"))
            assertThrows(CommandException::class.java) { computer.engage() }
        }
    }

    @Test
    fun `stamps of a wrong clock inhibit engaging, with the reason`() {
        val heard = Heard()
        FlightComputer(byPhone, folder(), heard, "fcc.wrong.clock").use { computer ->
            computer.start()
            eventually("the reason is reported") { heard.reports.any { "of no known clock" in it } }
            assertThrows(CommandException::class.java) { computer.engage() }
        }
    }

    @Test
    fun `a position is taken whether or not something flies by it`() {
        FlightComputer(BUILT_IN, folder()).use { computer ->
            computer.position(0, 48.0, 11.0, 500.0, 0.0)
            computer.start()
            computer.position(System.nanoTime(), 48.0, 11.0, 500.0, 0.0)
        }
        val closed = FlightComputer(BUILT_IN, folder())
        closed.close()
        assertThrows(ClosedException::class.java) { closed.position(0, 48.0, 11.0, 500.0, 0.0) }
    }

    @Test
    fun `it opens and closes the sensors a hundred times`() {
        FlightComputer("$byPhone\n[recording]\nenabled = false\n[realtime]\nlock_memory = false\n", folder()).use {
            repeat(100) { _ ->
                it.start()
                it.stop()
            }
        }
        eventually("its threads have ended: ${threads()}") { threads().none { it.startsWith("phone ") } }
    }
}
