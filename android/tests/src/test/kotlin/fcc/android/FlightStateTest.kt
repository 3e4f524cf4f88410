package fcc.android

import org.json.JSONObject
import org.junit.Assert.assertEquals
import org.junit.Assert.assertFalse
import org.junit.Assert.assertTrue
import org.junit.Test

class FlightStateTest {
    private fun reading(name: String, ageMs: Double) =
        Reading(JSONObject().put("name", name).put("source", 0).put("age_ms", ageMs))

    @Test
    fun `a reading is old sooner than a position`() {
        assertFalse(reading("airspeed", 250.0).isOld)
        assertTrue(reading("airspeed", 251.0).isOld)
        // One a second, under way for half of one.
        assertFalse(reading("satellite navigation", 1_500.0).isOld)
        assertTrue(reading("satellite navigation", 3_001.0).isOld)
    }

    @Test
    fun `a sensor that gives less than half of what it was asked for is slow`() {
        fun sensor(measuredHz: Double?, askedHz: Double?) = SensorHealth(
            JSONObject("""{"kind": "gyroscope", "name": "", "is_uncalibrated": true}""")
                .put("measured_hz", measuredHz)
                .put("asked_hz", askedHz),
        )
        val slow = listOf(100.0 to 100.0, 51.0 to 100.0, 49.0 to 100.0, null to 100.0, null to null)
            .map { (measuredHz, askedHz) -> sensor(measuredHz, askedHz).isSlow }
        assertEquals(listOf(false, false, true, false, false), slow)
    }
}
