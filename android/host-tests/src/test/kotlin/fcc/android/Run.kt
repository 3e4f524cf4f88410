package fcc.android

import java.io.File
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
    // A screen that draws, and a collector of garbage that has work.
    while (true) {
        computer.state()
        Thread.sleep(33)
    }
}
