package fcc.android

import java.net.DatagramPacket
import java.net.DatagramSocket
import java.net.InetAddress
import java.net.SocketAddress
import java.net.SocketException
import java.net.SocketTimeoutException
import java.nio.ByteBuffer
import java.nio.ByteOrder
import java.util.concurrent.ConcurrentHashMap
import kotlin.concurrent.thread
import kotlin.math.cos
import kotlin.math.sin

private const val POSITION = "sim/flightmodel/position"
private const val FLIGHT_TIME = "sim/time/total_flight_time_sec"
private const val OVERRIDE = "sim/operation/override/override_joystick"
private const val SWITCH = "sim/cockpit2/switches/generic_lights_switch[56]"

/** The first bytes of its messages, and where their names of datarefs are. */
private const val KIND_BYTES = 5
private const val REQUESTED_AT = 13
private const val WRITTEN_AT = 9

/**
 * X-Plane's messages RREF and DREF by UDP (its *Exchanging data with X-Plane*), of an
 * aircraft that flies straight and level at 100 kt, whatever is written.
 */
class XPlanePeer : AutoCloseable {
    private val values = ConcurrentHashMap(
        mapOf(
            "sim/time/paused" to 0f,
            "sim/time/framerate_period" to 0.02f,
            "sim/time/is_in_replay" to 0f,
            "sim/version/xplane_internal_version" to 115_501f,
            "sim/flightmodel/failures/onground_any" to 0f,
            "sim/flightmodel/engine/ENGN_thro_use[0]" to 0.65f,
            "sim/flightmodel2/position/pressure_altitude" to 3_000f,
            "sim/cockpit2/gauges/indicators/altitude_ft_pilot" to 3_000f,
            "sim/cockpit2/gauges/actuators/barometer_setting_in_hg_pilot" to 29.92f,
            "$POSITION/theta" to 3f,
            "$POSITION/phi" to 0f,
            "$POSITION/psi" to 270f,
            "$POSITION/mag_psi" to 270f,
            "$POSITION/alpha" to 3f,
            "$POSITION/indicated_airspeed" to 100f,
            "$POSITION/local_vx" to -53.8f,
            OVERRIDE to 0f,
            "sim/operation/override/override_throttles" to 0f,
            "sim/joystick/yoke_pitch_ratio" to 0f,
            "sim/joystick/yoke_roll_ratio" to 0f,
            "sim/joystick/yoke_heading_ratio" to 0f,
            SWITCH to 0f,
        ) + listOf("Prad", "Qrad", "Rrad", "local_ax", "local_ay", "local_az", "local_vy", "local_vz")
            .associate { "$POSITION/$it" to 0f },
    )

    /** By their numbers. */
    private val requested = ConcurrentHashMap<Int, String>()
    private val beganNs = System.nanoTime()

    @Volatile
    private var client: SocketAddress? = null

    @Volatile
    private var socket = DatagramSocket(0, InetAddress.getLoopbackAddress())
    private val port = socket.localPort

    /** As of a Wi-Fi that is lost: nothing arrives here, and nothing from here; it flies on. */
    @Volatile
    var isSilent = false

    /** Where it listens. */
    val address = "127.0.0.1:$port"

    /** Whether someone has control of its surfaces. */
    val isOverridden get() = values[OVERRIDE] == 1f

    init {
        serve()
    }

    /** Moves the pilot's engage switch. */
    fun switch(isOn: Boolean) {
        values[SWITCH] = if (isOn) 1f else 0f
    }

    /** Starts it again, at the same port. */
    fun restart() {
        socket = DatagramSocket(port, InetAddress.getLoopbackAddress())
        values[OVERRIDE] = 0f
        requested.clear()
        client = null
        serve()
    }

    /** Ends it: nobody listens at its port. */
    override fun close() = socket.close()

    private fun serve() {
        val socket = socket
        socket.soTimeout = FRAME_MS
        thread(isDaemon = true, name = "X-Plane") {
            try {
                while (true) {
                    receive(socket)
                    val to = client.takeIf { !isSilent } ?: continue
                    val frame = frame()
                    socket.send(DatagramPacket(frame, frame.size, to))
                }
            } catch (_: SocketException) {
                // It is closed.
            }
        }
    }

    /** What arrives until the next frame. */
    private fun receive(socket: DatagramSocket) {
        val packet = DatagramPacket(ByteArray(MOST_BYTES), MOST_BYTES)
        val until = System.nanoTime() + FRAME_MS * 1_000_000L
        while (System.nanoTime() < until) {
            try {
                packet.length = MOST_BYTES
                socket.receive(packet)
                if (!isSilent) take(packet)
            } catch (_: SocketTimeoutException) {
                return
            }
        }
    }

    private fun take(packet: DatagramPacket) {
        val bytes = ByteBuffer.wrap(packet.data, 0, packet.length).order(ByteOrder.LITTLE_ENDIAN)
        fun nameAt(at: Int) = String(packet.data, at, packet.length - at).substringBefore('\u0000')
        when (String(packet.data, 0, KIND_BYTES)) {
            "RREF\u0000" -> {
                val (rateHz, number) = bytes.getInt(KIND_BYTES) to bytes.getInt(KIND_BYTES + Int.SIZE_BYTES)
                client = packet.socketAddress
                if (rateHz == 0) requested.remove(number) else requested[number] = nameAt(REQUESTED_AT)
            }
            "DREF\u0000" -> values[nameAt(WRITTEN_AT)] = bytes.getFloat(KIND_BYTES)
        }
    }

    private fun frame(): ByteArray {
        val timeS = 100f + (System.nanoTime() - beganNs) / 1e9f
        values[FLIGHT_TIME] = timeS
        // It moves a little, as in still air: rates that never change are those of a dead sensor.
        val rate = ROCKS_RADPS * sin(ROCKS_PER_S * timeS)
        listOf("Prad", "Qrad", "Rrad").forEach { values["$POSITION/$it"] = rate }
        val angle = Math.toDegrees(-ROCKS_RADPS / ROCKS_PER_S * cos(ROCKS_PER_S * timeS).toDouble()).toFloat()
        values["$POSITION/phi"] = angle
        values["$POSITION/theta"] = LEVEL_PITCH_DEG + angle
        val known = requested.mapNotNull { (number, name) -> values[name]?.let { number to it } }
        val frame = ByteBuffer.allocate(KIND_BYTES + known.size * 2 * Int.SIZE_BYTES).order(ByteOrder.LITTLE_ENDIAN)
        frame.put("RREF,".toByteArray())
        known.forEach { (number, value) -> frame.putInt(number).putFloat(value) }
        return frame.array()
    }

    private companion object {
        const val FRAME_MS = 20
        const val ROCKS_RADPS = 0.002f
        const val ROCKS_PER_S = 3f
        const val LEVEL_PITCH_DEG = 3f
        const val MOST_BYTES = 2_048
    }
}
