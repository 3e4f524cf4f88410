package fcc.android

import java.io.File
import java.net.DatagramSocket
import java.net.InetAddress
import java.util.concurrent.Executors
import java.util.concurrent.LinkedBlockingQueue
import java.util.concurrent.TimeUnit
import org.json.JSONArray
import org.junit.Assert.assertEquals
import org.junit.Assert.assertFalse
import org.junit.Assert.assertNotNull
import org.junit.Assert.assertNull
import org.junit.Assert.assertThrows
import org.junit.Assert.assertTrue
import org.junit.Test

class FlightComputerTest {
    @Test
    fun `it flies, obeys commands and leaves a whole recording`() {
        val recordings = folder()
        val heard = Heard()
        FlightComputer(BUILT_IN, recordings, heard).use { computer ->
            assertFalse(computer.json().getBoolean("flying"))
            assertNull(computer.now())
            computer.start()
            assertTrue(computer.json().getBoolean("flying"))
            eventually("nothing inhibits engaging") {
                computer.now()?.getJSONArray("engage_inhibits")?.length() == 0
            }
            val engaged = computer.engage()
            eventually("engaged") { computer.now()!!.getString("state") == "engaged" }
            assertTrue(computer.set(mapOf("heading_rad" to 1.0, "altitude_m" to 1_000.0)) > engaged)
            eventually("the set points are shown") {
                val desired = computer.now()!!.optJSONObject("desired")
                desired != null && desired.getDouble("altitude_m") == 1_000.0
            }
            val now = computer.now()!!
            // The trimmed aircraft: level, and about as fast as it was set up.
            assertTrue(now.getDouble("airspeed_mps") in 40.0..70.0)
            assertTrue(Math.abs(now.getDouble("roll_rad")) < 0.6)
            computer.disengage()
            eventually("standby") { computer.now()!!.getString("state") == "standby" }
            eventually("the timing is known") { !computer.json().isNull("timing") }
            computer.stop()

            val end = computer.json()
            assertFalse(end.getBoolean("flying"))
            val outcome = end.getJSONObject("outcome")
            assertTrue(outcome.getBoolean("released"))
            val recording = outcome.getJSONObject("recording")
            assertEquals(0, recording.getLong("not_recorded"))
            assertEquals(outcome.getJSONObject("timing").getLong("ticks"), recording.getLong("ticks"))
            val listed = JSONArray(computer.recordings())
            assertEquals(1, listed.length())
            assertEquals("whole", listed.getJSONObject(0).getString("file"))
            assertEquals("built-in", listed.getJSONObject(0).getString("plant"))
            assertEquals(recording.getLong("ticks"), listed.getJSONObject(0).getLong("ticks"))
        }
        assertNotNull(heard.ending())
        assertEquals(listOf("standby", "engaged", "standby", "stopped"), heard.states.toList())
        assertFalse(heard.threads.any { it.contains("loop") })
        assertTrue(heard.reports.any { "engaged" in it })
    }

    @Test
    fun `the listener is told a state when it can be read`() {
        val told = LinkedBlockingQueue<Pair<String, String?>>()
        lateinit var computer: FlightComputer
        val listener = object : Listener by Heard() {
            override fun stateChanged(state: String) {
                told.add(state to computer.now()?.getString("state"))
            }
        }
        fun isTold(state: String) = assertEquals(state to state, told.poll(20, TimeUnit.SECONDS))
        computer = FlightComputer(BUILT_IN, folder(), listener)
        computer.use {
            computer.start()
            isTold("standby")
            eventually("ready") { computer.now()?.getJSONArray("engage_inhibits")?.length() == 0 }
            computer.engage()
            isTold("engaged")
            computer.disengage()
            isTold("standby")
        }
    }

    /** SCHED_FIFO or the lowest nice value that is granted, as the kernel says it. */
    @Test
    fun `what the loop's thread was granted is what the kernel says`() {
        FlightComputer(BUILT_IN, folder()).use { computer ->
            computer.start()
            val granted = computer.json().getJSONObject("granted")
            val loop = File("/proc/self/task").listFiles()!!.single {
                File(it, "comm").readText().trim() == "fcc-loop"
            }
            // Fields 19 and 41 of proc_pid_stat(5), the first two before the name's end.
            val fields = File(loop, "stat").readText().substringAfterLast(") ").split(" ")
            assertEquals(fields[19 - 3].toInt(), granted.getInt("nice"))
            val policy = if (fields[41 - 3].toInt() == 1) "SCHED_FIFO" else "SCHED_OTHER"
            assertEquals(policy, granted.getString("policy"))
        }
    }

    /** A twentieth of the period, 25 ms. The fake libandroid plays Android 13 or newer. */
    @Test
    fun `the system is told how long a tick may take and took`() {
        FlightComputer(BUILT_IN, folder()).use { computer ->
            assertNull(computer.hints())
            computer.start()
            eventually("reports") { computer.hints()!!.getLong("reports") >= 3 }
            assertTrue(computer.hints()!!.getBoolean("session"))
            assertTrue(computer.hints()!!.isNull("why"))
            assertEquals(1_250.0, computer.hints()!!.getDouble("target_us"), 0.0)
            computer.stop()
            assertFalse(computer.hints()!!.getBoolean("session"))
        }
    }

    @Test
    fun `a bad configuration is refused with the line and the key`() {
        val wrong = assertThrows(ConfigException::class.java) {
            FlightComputer("[built-in]\n[loop]\nrate_hz = -1\n", folder())
        }
        assertTrue(wrong.message, "3" in wrong.message!! && "loop.rate_hz" in wrong.message!!)
        assertThrows(ConfigException::class.java) { FlightComputer("no = toml =", folder()) }
        assertThrows(ConfigException::class.java) { FlightComputer("", folder()) }
    }

    @Test
    fun `a port that another program has is an exception`() {
        DatagramSocket(0, InetAddress.getByName("127.0.0.1")).use { taken ->
            val config = "[x-plane]\nsimulator = \"127.0.0.1:9\"\nlocal_port = ${taken.localPort}\n"
            FlightComputer(config, folder()).use { computer ->
                val refused = assertThrows(FlightException::class.java) { computer.start() }
                assertTrue(refused.message, "X-Plane" in refused.message!!)
                assertFalse(computer.json().getBoolean("flying"))
            }
        }
    }

    @Test
    fun `a command that makes no sense is refused with the reason`() {
        FlightComputer(BUILT_IN, folder()).use { computer ->
            val refused = { act: () -> Unit ->
                assertThrows(CommandException::class.java) { act() }.message!!
            }
            assertTrue("start" in refused { computer.engage() })
            computer.start()
            eventually("ready") { computer.now()?.getJSONArray("engage_inhibits")?.length() == 0 }
            assertTrue("while engaged" in refused { computer.set(mapOf("heading_rad" to 1.0)) })
            computer.engage()
            assertTrue("choose" in refused { computer.set(mapOf("airspeed_mps" to 900.0)) })
            assertTrue("room_c" in refused { computer.set(mapOf("room_c" to 20.0)) })
            assertTrue("no command" in refused { computer.set(mapOf("heading_rad" to Double.NaN)) })
            assertTrue("flies already" in assertThrows(FlightException::class.java) { computer.start() }.message!!)
        }
    }

    /** Whatever a name is, it is one, and not a part of the command. */
    @Test
    fun `a set point that is no name or no number is refused with it`() {
        FlightComputer(BUILT_IN, folder()).use { computer ->
            computer.start()
            eventually("ready") { computer.now()?.getJSONArray("engage_inhibits")?.length() == 0 }
            computer.engage()
            for (name in listOf("\"", "\\", "\u0000", "\uD800", "heading_rad\",1.0],[\"airspeed_mps", "a\nb")) {
                val refused = assertThrows(name, CommandException::class.java) { computer.set(mapOf(name to 50.0)) }
                assertTrue(refused.message, "there is no set point" in refused.message!!)
            }
            for (value in listOf(Double.NaN, Double.POSITIVE_INFINITY, Double.NEGATIVE_INFINITY)) {
                val refused = assertThrows(CommandException::class.java) { computer.set(mapOf("heading_rad" to value)) }
                assertTrue(refused.message, "heading_rad is $value" in refused.message!!)
            }
        }
    }

    /** The thread of the flight that has ended may still be there. */
    @Test
    fun `a listener that is told the end may start the next flight at once`() {
        val flights = 200
        val refused = LinkedBlockingQueue<String>()
        val ended = java.util.concurrent.CountDownLatch(flights)
        lateinit var computer: FlightComputer
        val listener = object : Listener by Heard() {
            override fun stateChanged(state: String) {
                if (state == "standby") kotlin.concurrent.thread { computer.stop() }
            }

            override fun ended(reason: String) {
                ended.countDown()
                if (ended.count > 0) runCatching { computer.start() }.onFailure { refused.add("$it") }
            }
        }
        val config = "$BUILT_IN[recording]\nenabled = false\n[loop]\nrate_hz = 500\n[realtime]\nlock_memory = false\n"
        computer = FlightComputer(config, folder(), listener)
        computer.use {
            it.start()
            assertTrue("${ended.count} left, $refused", ended.await(60, TimeUnit.SECONDS))
            assertEquals(emptyList<String>(), refused.toList())
        }
    }

    /** What is told to the second process, and the file `held`, are of one flight. */
    @Test
    fun `while a flight may hold X-Plane no other one begins, and what it holds stays stored`() {
        fun config(of: XPlanePeer) = "[x-plane]\nsimulator = \"${of.address}\"\n[engage]\ncommand_needs_switch = false\n" +
            "[guidance]\nmode = \"hold\"\n[realtime]\nlock_memory = false\n"
        XPlanePeer().use { xPlane ->
            XPlanePeer().use { anotherXPlane ->
                val recordings = folder()
                FlightComputer(config(xPlane), recordings).use { first ->
                    first.start()
                    eventually("ready", 40) { first.now()?.getJSONArray("engage_inhibits")?.length() == 0 }
                    first.engage()
                    eventually("it is held") { xPlane.isOverridden && File(recordings, "held").exists() }
                    for (peer in listOf(xPlane, anotherXPlane)) {
                        FlightComputer(config(peer), recordings).use { second ->
                            val refused = assertThrows(FlightException::class.java) { second.start() }
                            assertTrue(refused.message, "another flight" in refused.message!!)
                        }
                    }
                    Thread.sleep(500)
                    assertTrue(File(recordings, "held").exists())
                    assertTrue(xPlane.isOverridden)
                    assertEquals("engaged", first.now()!!.getString("state"))
                    first.stop()
                    assertFalse(File(recordings, "held").exists())
                }
                FlightComputer(config(anotherXPlane), recordings).use { it.start() }
            }
        }
    }

    @Test
    fun `after it is closed every method says so, in any thread`() {
        val computer = FlightComputer(BUILT_IN, folder())
        computer.start()
        computer.close()
        computer.close()
        val methods = listOf<() -> Unit>(
            { computer.start() },
            { computer.stop() },
            { computer.state() },
            { computer.engage() },
            { computer.recordings() },
        )
        for (method in methods) {
            assertThrows(ClosedException::class.java) { method() }
        }
        assertThrows(ClosedException::class.java) { Native.state(Long.MIN_VALUE) }
        val another = Executors.newSingleThreadExecutor()
        another.submit { assertThrows(ClosedException::class.java) { computer.state() } }.get()
        another.shutdown()
        eventually("its threads have ended: ${ownThreads()}") { ownThreads().isEmpty() }
    }

    @Test
    fun `it is stopped and closed from other threads, at once`() {
        repeat(20) {
            val computer = FlightComputer(BUILT_IN, folder(), Heard())
            computer.start()
            val others = Executors.newFixedThreadPool(4)
            val asked = listOf(
                others.submit { runCatching { computer.stop() } },
                others.submit { runCatching { computer.engage() } },
                others.submit { runCatching { repeat(100) { computer.state() } } },
                others.submit { computer.close() },
            )
            asked.forEach { it.get(20, TimeUnit.SECONDS) }
            others.shutdown()
            assertThrows(ClosedException::class.java) { computer.state() }
        }
    }

    @Test
    fun `a listener may stop the flight, and what it throws is its own`() {
        lateinit var computer: FlightComputer
        val ended = java.util.concurrent.CountDownLatch(1)
        val listener = object : Listener {
            override fun stateChanged(state: String) {
                if (state == "standby") computer.stop()
                throw IllegalStateException("the listener's own")
            }

            override fun reported(text: String) = throw OutOfMemoryError("of the listener")

            override fun ended(reason: String) = ended.countDown()
        }
        computer = FlightComputer(BUILT_IN, folder(), listener)
        computer.use {
            it.start()
            assertTrue(ended.await(10, TimeUnit.SECONDS))
            assertFalse(it.json().getBoolean("flying"))
        }
    }

    @Test
    fun `it starts and stops a thousand times`() {
        val recordings = folder()
        // Fast, so that a stop does not wait long for a tick. To lock all memory of a
        // Java process takes 0.2 s, and phones refuse it.
        val config = "$BUILT_IN[recording]\nenabled = false\n[loop]\nrate_hz = 500\n" +
            "[realtime]\nlock_memory = false\n"
        FlightComputer(config, recordings, Heard()).use { computer ->
            repeat(1_000) {
                computer.start()
                computer.stop()
            }
            assertTrue(computer.json().getJSONObject("outcome").getBoolean("released"))
        }
        eventually("its threads have ended: ${ownThreads()}") { ownThreads().isEmpty() }
    }

    @Test
    fun `ten thousand calls leave no reference`() {
        val nothing = folder()
        FlightComputer("$BUILT_IN[recording]\nenabled = false\n", nothing, Heard()).use { computer ->
            computer.start()
            val call = { _: Int ->
                computer.state()
                runCatching { computer.set(mapOf("heading_rad" to Double.NaN)) }
                computer.recordings()
                runCatching { FlightComputer("wrong", nothing) }
                Unit
            }
            repeat(10) { call(it) }
            val before = globalReferences()
            repeat(2_500) { call(it) }
            assertTrue(globalReferences() <= before)
        }
        val before = globalReferences()
        repeat(100) { FlightComputer(BUILT_IN, folder(), Heard()).close() }
        eventually("the listeners are let go: ${globalReferences()} after $before") {
            globalReferences() <= before
        }
    }
}
