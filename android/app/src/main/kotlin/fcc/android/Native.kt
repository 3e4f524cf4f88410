package fcc.android

/**
 * The native methods of `libfcc_android.so` (crates/fcc-android/src/native.rs).
 *
 * Use [FlightComputer]. A handle is a number that is given once; a method with
 * one that is closed throws [ClosedException].
 */
internal object Native {
    init {
        System.loadLibrary("fcc_android")
    }

    @JvmStatic
    external fun create(config: String, recordings: String, packageName: String, listener: Listener?): Long

    @JvmStatic
    external fun start(handle: Long)

    @JvmStatic
    external fun stop(handle: Long)

    @JvmStatic
    external fun state(handle: Long): String

    @JvmStatic
    external fun command(handle: Long, command: String): Long

    @JvmStatic
    @Suppress("LongParameterList")
    external fun position(
        handle: Long,
        elapsedRealtimeNs: Long,
        latitudeDeg: Double,
        longitudeDeg: Double,
        altitudeM: Double,
        speedMps: Double,
        bearingDeg: Double,
        horizontalAccuracyM: Double,
        verticalAccuracyM: Double,
        speedAccuracyMps: Double,
    )

    @JvmStatic
    external fun recordings(handle: Long): String

    @JvmStatic
    external fun report(file: String): String

    @JvmStatic
    external fun close(handle: Long)
}
