package fcc.android

/**
 * The native methods of `libfcc_android.so` (crates/fcc-android/src/native.rs).
 *
 * Use [FlightComputer]. A handle is a number that is given once; a method with
 * one that is closed throws [ClosedException].
 */
internal object Native {
    /** Why there are no such methods; null if there are. */
    private val problem: String? = try {
        System.loadLibrary("fcc_android")
        null
    } catch (error: UnsatisfiedLinkError) {
        error.message.orEmpty()
    }

    /**
     * This, before the first call.
     *
     * @throws LibraryException if the package has no library for this processor.
     */
    fun loaded(): Native = problem?.let { throw LibraryException(it) } ?: this

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
    external fun calibrations(config: String, recordings: String): String

    @JvmStatic
    external fun calibrate(config: String, recordings: String, packageName: String, kind: String): Long

    @JvmStatic
    external fun calibration(handle: Long): String

    @JvmStatic
    external fun endCalibration(handle: Long)

    @JvmStatic
    external fun tellHelper(pipe: Int)

    @JvmStatic
    external fun helpRelease(pipe: Int, recordings: String): String

    @JvmStatic
    external fun releaseLeft(recordings: String): String

    @JvmStatic
    external fun close(handle: Long)
}
