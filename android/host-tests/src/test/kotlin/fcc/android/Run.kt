package fcc.android

import java.io.File
import java.net.DatagramPacket
import java.net.DatagramSocket
import java.net.InetAddress
import kotlin.concurrent.thread
import kotlin.system.exitProcess
import org.json.JSONObject

/**
 * Flies a configuration as `fccd run --config FILE --json` does, in this process:
 * until SIGINT or SIGTERM, and then prints the outcome. For the programs of `hil/`,
 * by `android/host-tests/fccd`.
 */
fun main(words: Array<String>) {
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
    computer.start()
    System.getenv("FCC_POSITIONS_PORT")?.let { handPositionsIn(computer, it.toInt()) }
    // A screen that draws, and a collector of garbage that has work.
    while (true) {
        computer.state()
        Thread.sleep(33)
    }
}

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
