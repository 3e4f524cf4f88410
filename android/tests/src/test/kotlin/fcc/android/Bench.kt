package fcc.android

import java.io.File
import java.lang.management.ManagementFactory
import java.nio.file.Files
import java.util.concurrent.ConcurrentLinkedQueue
import java.util.concurrent.LinkedBlockingQueue
import java.util.concurrent.TimeUnit
import javax.management.ObjectName
import org.json.JSONObject
import org.junit.Assert.fail

/** The built-in aircraft, whose engage switch stays off: commands engage it. */
const val BUILT_IN = """
[built-in]
engage_at_s = 600.0
[engage]
command_needs_switch = false
[guidance]
mode = "hold"
"""

/** A folder for recordings that is removed with the process. */
fun folder(): File = Files.createTempDirectory("fcc-android").toFile().also { made.add(it) }

private val made = ConcurrentLinkedQueue<File>().also { folders ->
    Runtime.getRuntime().addShutdownHook(Thread { folders.forEach { it.deleteRecursively() } })
}

/** The state as JSON. */
fun FlightComputer.json() = JSONObject(state())

/** The newest tick; null before the first. */
fun FlightComputer.now(): JSONObject? = json().optJSONObject("now")

/** The performance hints of the loop's thread; null before a flight. */
fun FlightComputer.hints(): JSONObject? = json().optJSONObject("performance_hints")

/** Waits until something holds, for ten seconds unless told. */
fun eventually(what: String, seconds: Int = 10, holds: () -> Boolean) {
    repeat(100 * seconds) {
        if (holds()) return
        Thread.sleep(10)
    }
    fail("not within $seconds s: $what")
}

/** Keeps what it is told. */
class Heard : Listener {
    val states = LinkedBlockingQueue<String>()
    val reports = LinkedBlockingQueue<String>()
    val endings = LinkedBlockingQueue<String>()
    val threads = LinkedBlockingQueue<String>()

    override fun stateChanged(state: String) {
        threads.add(Thread.currentThread().name)
        states.add(state)
    }

    override fun reported(text: String) {
        reports.add(text)
    }

    override fun ended(reason: String) {
        endings.add(reason)
    }

    fun ending(): String? = endings.poll(10, TimeUnit.SECONDS)
}

/** How many global references native code holds, as a thread dump says. */
fun globalReferences(): Int {
    System.gc()
    val dump = ManagementFactory.getPlatformMBeanServer().invoke(
        ObjectName("com.sun.management:type=DiagnosticCommand"),
        "threadPrint",
        arrayOf<Any?>(emptyArray<String>()),
        arrayOf(Array<String>::class.java.name),
    ) as String
    return Regex("JNI global refs: (\\d+)").find(dump)!!.groupValues[1].toInt()
}

/** Threads of this process, Java's and native ones: proc_pid_task(5). */
fun threads(): List<String> =
    File("/proc/self/task").listFiles()!!.mapNotNull { task ->
        runCatching { File(task, "comm").readText().trim() }.getOrNull()
    }

/** Those of the library. */
fun ownThreads(): List<String> = threads().filter { it.startsWith("fcc-") }

/** What only the library with faults on request understands. */
fun FlightComputer.request(what: String): Long {
    val handle = FlightComputer::class.java.getDeclaredField("handle")
    handle.isAccessible = true
    return Native.command(handle.getLong(this), what)
}
