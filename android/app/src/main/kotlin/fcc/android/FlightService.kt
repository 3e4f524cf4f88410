package fcc.android

import android.app.Service
import android.content.Context
import android.content.Intent
import android.content.pm.ServiceInfo
import android.os.Build
import android.os.Handler
import android.os.IBinder
import android.os.Looper
import java.io.IOException
import java.util.concurrent.Executors

/**
 * Keeps the flight going while no screen is there: a service in the foreground, with
 * a notification that shows the state and can end the flight.
 *
 * Nothing flies unasked: if the system restarts the service it ends itself.
 */
class FlightService : Service() {
    private val main = Handler(Looper.getMainLooper())

    /** Assembles, begins and ends flights, one after the other. */
    private val worker = Executors.newSingleThreadExecutor { Thread(it, "flight-service") }
    private lateinit var notification: FlightNotification
    private lateinit var keepAwake: KeepAwake
    private lateinit var poller: StatePoller<FlightState>
    private var positions: Positions? = null
    private var lastStartId = 0

    /** The number of the flight; what belongs to an earlier one is ignored. */
    private var flights = 0

    override fun onCreate() {
        super.onCreate()
        notification = FlightNotification(this)
        keepAwake = KeepAwake(this)
        poller = StatePoller(NOTIFIED_EVERY_MS, Flight::state) { notification.show(it) }
    }

    override fun onStartCommand(intent: Intent?, flags: Int, startId: Int): Int {
        lastStartId = startId
        val config = if (intent?.action == START) Configuration(this).text() else null
        // Whoever starts a service in the foreground has promised its notification.
        val isForeground = showInForeground(config)
        when {
            intent?.action == STOP -> end()
            config != null && isForeground -> begin(config)
        }
        // Nothing is to be done, or an earlier service still ends its flight.
        if (flights == 0 || Flight.phase == Phase.IDLE) leave()
        return START_NOT_STICKY
    }

    private fun begin(config: String) {
        if (Flight.phase != Phase.IDLE) return
        flights += 1
        val flight = flights
        Flight.phase = Phase.BEGINNING
        keepAwake.acquire()
        ReleaseLink.open(applicationContext)
        // It reads the same sensors.
        Calibrations.end()
        if (Configuration.usesPhone(config)) positions = Positions(this).also { it.start() }
        poller.start()
        worker.execute {
            val refusal = try {
                Flight.begin(config, Recordings.folder(this), FlightListener(flight))
                null
            } catch (error: FccException) {
                error.message.orEmpty()
            } catch (error: IOException) {
                error.message.orEmpty()
            }
            refusal?.let(Flight::refuse)
            main.post {
                when {
                    flight != flights -> Unit
                    refusal != null -> finish(flight)
                    Flight.phase == Phase.BEGINNING -> Flight.phase = Phase.FLYING
                }
            }
        }
    }

    private fun end() {
        when (Flight.phase) {
            Phase.IDLE, Phase.ENDING -> Unit
            Phase.BEGINNING, Phase.FLYING -> {
                Flight.phase = Phase.ENDING
                val flight = flights
                worker.execute {
                    Flight.end()
                    main.post { finish(flight) }
                }
            }
        }
    }

    /** The flight is over. */
    private fun finish(flight: Int) {
        if (flight != flights || Flight.phase == Phase.IDLE) return
        Flight.phase = Phase.IDLE
        stopFeeding()
        keepAwake.release()
        leave()
    }

    private fun leave() {
        stopForeground(STOP_FOREGROUND_REMOVE)
        // Not if it has been started again meanwhile.
        stopSelfResult(lastStartId)
    }

    private fun stopFeeding() {
        poller.stop()
        positions?.stop()
        positions = null
    }

    /** Whether the system permits it; if not, nothing flies, and the screens say why. */
    private fun showInForeground(config: String?): Boolean = try {
        val shown = notification.of(Flight.phase)
        if (Build.VERSION.SDK_INT >= Build.VERSION_CODES.Q) {
            startForeground(FlightNotification.ID, shown, types(config))
        } else {
            startForeground(FlightNotification.ID, shown)
        }
        true
    } catch (error: IllegalStateException) {
        refused(error)
    } catch (error: SecurityException) {
        refused(error)
    }

    private fun refused(error: RuntimeException): Boolean {
        // What flies goes on, and its state is what the screens have to show.
        if (Flight.phase == Phase.IDLE) Flight.refuse(getString(R.string.service_refused, error.message.orEmpty()))
        return false
    }

    /**
     * Without the permission for locations the system refuses that type. In flight it is what
     * flies that counts, and not what has been saved meanwhile.
     */
    private fun types(config: String?): Int {
        val next = config.takeIf { Flight.phase == Phase.IDLE }
        val uses = next?.let(Configuration::usesPhone) ?: (positions != null)
        val location = if (uses && Positions.isPermitted(this)) ServiceInfo.FOREGROUND_SERVICE_TYPE_LOCATION else 0
        return ServiceInfo.FOREGROUND_SERVICE_TYPE_CONNECTED_DEVICE or location
    }

    override fun onDestroy() {
        // Of an earlier service that still ends its flight this one knows nothing.
        val isFlying = flights > 0 && Flight.phase != Phase.IDLE
        flights += 1
        stopFeeding()
        worker.execute {
            if (isFlying) {
                Flight.end()
                main.post { Flight.phase = Phase.IDLE }
            }
            keepAwake.release()
        }
        // What is under way is finished.
        worker.shutdown()
        super.onDestroy()
    }

    override fun onBind(intent: Intent?): IBinder? = null

    private inner class FlightListener(private val flight: Int) : Listener {
        override fun stateChanged(state: String) {
            val now = Flight.state()
            main.post { if (flight == flights && Flight.phase != Phase.IDLE) notification.show(now) }
        }

        override fun reported(text: String) = Unit

        override fun ended(reason: String) {
            main.post { finish(flight) }
        }
    }

    companion object {
        private const val START = "fcc.android.START"
        internal const val STOP = "fcc.android.STOP"
        private const val NOTIFIED_EVERY_MS = 1_000L

        /** Begins a flight by the saved configuration, if nothing flies. From a screen only. */
        fun start(context: Context) {
            context.startForegroundService(Intent(context, FlightService::class.java).setAction(START))
        }

        /** Ends the flight. */
        fun stop(context: Context) {
            context.startService(Intent(context, FlightService::class.java).setAction(STOP))
        }
    }
}
