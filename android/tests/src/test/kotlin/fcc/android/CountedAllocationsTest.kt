package fcc.android

import org.junit.Assert.assertEquals
import org.junit.Assert.assertTrue
import org.junit.Test

/** With the library that counts the calls of its allocator. */
class CountedAllocationsTest {
    @Test
    fun `the loop does not allocate while Java does`() {
        for (config in listOf(BUILT_IN, RAW)) {
            FlightComputer(config, folder()).use { computer ->
                computer.start()
                eventually("nothing inhibits engaging", 40) {
                    computer.now()?.getJSONArray("engage_inhibits")?.length() == 0
                }
                computer.engage()
                eventually("engaged") { computer.now()!!.getString("state") == "engaged" }
                val (calls, tick) = computer.request("allocator calls") to computer.tick()
                // What the thread allocates before its first tick is counted.
                assertTrue("$calls calls", calls > 0)
                var garbage = 0L
                while (computer.tick() < tick + TICKS) {
                    garbage += ByteArray(1_000_000).size
                    computer.set(mapOf("heading_rad" to garbage % 6 * 1.0))
                    System.gc()
                }
                assertEquals("engaged", computer.now()!!.getString("state"))
                assertEquals(calls, computer.request("allocator calls"))
                // One that does would be seen.
                computer.request("allocate in the loop")
                eventually("it is counted") { computer.request("allocator calls") > calls }
            }
        }
    }

    private fun FlightComputer.tick() = now()!!.getLong("tick")

    private companion object {
        /** Ten seconds at 40 Hz. */
        const val TICKS = 400

        /** By the raw sensors of a board, which the filter needs. */
        const val RAW = """
[built-in]
engage_at_s = 600.0
raw_sensors = "board"
[navigation]
method = "kalman"
[engage]
command_needs_switch = false
[guidance]
mode = "hold"
"""
    }
}
