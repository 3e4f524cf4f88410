package fcc.android

import java.io.File
import java.io.RandomAccessFile
import java.net.DatagramPacket
import java.net.DatagramSocket
import java.net.InetAddress
import java.nio.file.Files
import kotlin.concurrent.thread
import kotlin.system.exitProcess
import org.json.JSONObject

/**
 * Flies a configuration as `fccd run --config FILE --json` does, in this process:
 * until SIGINT or SIGTERM, and then prints the outcome. For the programs of `hil/`,
 * by `android/tests/fccd`.
 */
fun main(words: Array<String>) {
    if (words.firstOrNull() == HELPER) {
        System.err.println(Native.helpRelease(0, words[1]))
        return
    }
    if (words.firstOrNull() == FLIGHTS) return flights(words[1].toInt())
    val config = words.getOrNull(words.indexOf("--config") + 1)
    if (words.firstOrNull() != "run" || config == null) {
        System.err.println("give: run --config FILE [--recordings DIR] [--json]")
        exitProcess(2)
    }
    val at = words.indexOf("--recordings")
    val recordings = File(if (at < 0) "recordings" else words[at + 1])
    val listener = object : Listener {
        override fun stateChanged(state: String) = Unit

        override fun reported(text: String) = System.err.println(text)

        override fun ended(reason: String) = exitProcess(0)
    }
    val computer = FlightComputer(File(config).readText(), recordings, listener)
    Runtime.getRuntime().addShutdownHook(
        Thread {
            computer.stop()
            val state = JSONObject(computer.state())
            println(state.opt("outcome") ?: state)
            System.out.flush()
            // SIGINT's exit code is Java's otherwise.
            Runtime.getRuntime().halt(0)
        },
    )
    if (System.getenv("FCC_RELEASE_HELPER") != null) startHelper(recordings)
    // What an app does first.
    if (System.getenv("FCC_RELEASE_LEFT") != null) {
        println(Native.releaseLeft(recordings.path))
        Runtime.getRuntime().halt(0)
    }
    computer.start()
    System.getenv("FCC_POSITIONS_PORT")?.let { handPositionsIn(computer, it.toInt()) }
    // A screen that draws, and a collector of garbage that has work.
    while (true) {
        computer.state()
        Thread.sleep(33)
    }
}

private const val FLIGHTS = "flights"

/** Flies this often, recorded, and prints what memory the process has after ten flights and at the end, KiB. */
private fun flights(count: Int) {
    val config = "$BUILT_IN[loop]\nrate_hz = 500\n[realtime]\nlock_memory = false\n"
    val recordings = folder()
    FlightComputer(config, recordings, Heard()).use { computer ->
        repeat(count) { flown ->
            if (flown == 10) println(residentKib())
            computer.start()
            computer.state()
            computer.stop()
            recordings.listFiles()!!.forEach { it.delete() }
        }
        println(residentKib())
    }
}

/** VmRSS of proc_pid_status(5). */
private fun residentKib(): Int {
    System.gc()
    val status = File("/proc/self/status").readText()
    return Regex("VmRSS:\\s+(\\d+) kB").find(status)!!.groupValues[1].toInt()
}

private const val HELPER = "help-release"

/** A second process, as Android would start it, at the end of a pipe that has a name. */
private fun startHelper(recordings: File) {
    val pipe = File(folder(), "pipe")
    ProcessBuilder("mkfifo", pipe.path).start().waitFor()
    // For both, or it would wait for the other end.
    written = RandomAccessFile(pipe, "rw")
    val java = ProcessHandle.current().info().command().get()
    val properties = listOf("-Djava.library.path=" + System.getProperty("java.library.path"))
    val classes = listOf("-cp", System.getProperty("java.class.path"), "fcc.android.RunKt")
    ProcessBuilder(listOf(java) + properties + classes + listOf(HELPER, recordings.path))
        .redirectInput(pipe)
        .redirectError(ProcessBuilder.Redirect.INHERIT)
        .start()
    val ours = File("/proc/self/fd").listFiles()!!.single {
        runCatching { Files.readSymbolicLink(it.toPath()).toString() }.getOrNull() == pipe.path
    }
    Native.tellHelper(ours.name.toInt())
}

/** Never closed. */
private lateinit var written: RandomAccessFile

/** As the location service would: datagrams with the values of a position, as JSON. */
private fun handPositionsIn(computer: FlightComputer, port: Int) {
    val socket = DatagramSocket(port, InetAddress.getLoopbackAddress())
    thread(isDaemon = true, name = "positions") {
        val packet = DatagramPacket(ByteArray(65_536), 65_536)
        while (true) {
            packet.length = 65_536
            socket.receive(packet)
            val position = JSONObject(String(packet.data, 0, packet.length))
            computer.position(
                elapsedRealtimeNs = position.getLong("elapsed_realtime_ns"),
                latitudeDeg = position.getDouble("latitude_deg"),
                longitudeDeg = position.getDouble("longitude_deg"),
                altitudeM = position.getDouble("altitude_m"),
                speedMps = position.getDouble("speed_mps"),
                bearingDeg = position.getDouble("bearing_deg"),
            )
        }
    }
}
