package fcc.android

import android.Manifest
import android.annotation.SuppressLint
import android.content.Context
import android.content.pm.PackageManager
import android.location.Location
import android.location.LocationListener
import android.location.LocationManager
import android.location.OnNmeaMessageListener
import android.os.Build
import android.os.Bundle
import android.os.Handler
import android.os.HandlerThread

/** Hands the positions of the phone's satellite receiver to the flight. */
class Positions(private val context: Context) : LocationListener {
    private val manager = context.getSystemService(LocationManager::class.java)
    private var thread: HandlerThread? = null

    /** How far the geoid is above the ellipsoid here, by the receiver's GGA sentences. */
    private var geoidM = Double.NaN
    private val nmea = OnNmeaMessageListener { sentence, _ -> Nmea.geoidM(sentence)?.let { geoidM = it } }

    /** Begins, if it is permitted and there is a receiver. */
    @SuppressLint("MissingPermission")
    fun start() {
        if (!isPermitted(context) || LocationManager.GPS_PROVIDER !in manager.allProviders) return
        val thread = HandlerThread("positions").also { it.start() }
        this.thread = thread
        // As many as there are.
        manager.requestLocationUpdates(LocationManager.GPS_PROVIDER, 0L, 0f, this, thread.looper)
        manager.addNmeaListener(nmea, Handler(thread.looper))
    }

    /** Ends; without effect the second time. */
    fun stop() {
        manager.removeUpdates(this)
        manager.removeNmeaListener(nmea)
        thread?.quitSafely()
        thread = null
    }

    override fun onLocationChanged(location: Location) {
        val flight = Flight.ifFlying() ?: return
        try {
            flight.position(
                elapsedRealtimeNs = location.elapsedRealtimeNanos,
                latitudeDeg = location.latitude,
                longitudeDeg = location.longitude,
                altitudeM = altitudeM(location),
                speedMps = known(location.hasSpeed(), location.speed),
                bearingDeg = known(location.hasBearing(), location.bearing),
                horizontalAccuracyM = known(location.hasAccuracy(), location.accuracy),
                verticalAccuracyM = known(location.hasVerticalAccuracy(), location.verticalAccuracyMeters),
                speedAccuracyMps = known(location.hasSpeedAccuracy(), location.speedAccuracyMetersPerSecond),
            )
        } catch (_: ClosedException) {
            // The flight has ended meanwhile.
        }
    }

    /** Above mean sea level; a location's own altitude is above the ellipsoid. */
    private fun altitudeM(location: Location): Double = when {
        Build.VERSION.SDK_INT >= Build.VERSION_CODES.UPSIDE_DOWN_CAKE && location.hasMslAltitude() ->
            location.mslAltitudeMeters
        location.hasAltitude() -> location.altitude - geoidM
        else -> Double.NaN
    }

    private fun known(has: Boolean, value: Float) = if (has) value.toDouble() else Double.NaN

    // Before Android 11 these have no default.
    override fun onProviderEnabled(provider: String) = Unit

    override fun onProviderDisabled(provider: String) = Unit

    @Deprecated("Not called since Android 10")
    override fun onStatusChanged(provider: String?, status: Int, extras: Bundle?) = Unit

    companion object {
        /** Whether the user permits precise locations. */
        fun isPermitted(context: Context) =
            context.checkSelfPermission(Manifest.permission.ACCESS_FINE_LOCATION) == PackageManager.PERMISSION_GRANTED
    }
}
