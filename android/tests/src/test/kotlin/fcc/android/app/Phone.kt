package fcc.android.app

import android.app.Activity
import android.app.Application
import android.app.Notification
import android.app.NotificationManager
import android.content.ComponentName
import android.content.Intent
import android.os.Looper
import android.view.View
import android.view.ViewGroup
import android.widget.Button
import android.widget.TextView
import fcc.android.Configuration
import fcc.android.Flight
import fcc.android.FlightNotification
import fcc.android.FlightService
import fcc.android.FlightState
import fcc.android.Phase
import fcc.android.R
import fcc.android.Recordings
import fcc.android.ReleaseService
import fcc.android.screens.MainActivity
import java.time.Duration
import org.junit.Assert.assertTrue
import org.junit.Assert.fail
import org.junit.rules.ExternalResource
import org.robolectric.Robolectric
import org.robolectric.RuntimeEnvironment
import org.robolectric.Shadows.shadowOf
import org.robolectric.android.controller.ServiceController

/** The built-in aircraft, which commands engage; ready at once. */
const val FLOWN = """
[built-in]
engage_at_s = 600.0
[engage]
command_needs_switch = false
[guidance]
mode = "hold"
[realtime]
lock_memory = false
"""

/** By the phone's sensors, which the fake libandroid plays. */
const val BY_PHONE = """
actuator = []
[navigation]
method = "kalman"
[[sensor]]
kind = "phone"
position = false
"""

/**
 * What Android does and Robolectric leaves to the test: it delivers what starts a
 * service, destroys the service that has ended itself, and lets time pass.
 */
class Phone : ExternalResource() {
    val app: Application get() = RuntimeEnvironment.getApplication()
    val recordings get() = Recordings(Recordings.folder(app))
    var service: ServiceController<FlightService>? = null
        private set
    private var starts = 0

    /** What was started as a service, until now. */
    val started = mutableListOf<Intent>()

    override fun before() {
        Configuration(app).save(FLOWN)
        // There is one process only, and Robolectric's pipes are files.
        shadowOf(app).declareComponentUnbindable(ComponentName(app, ReleaseService::class.java))
    }

    override fun after() {
        if (Flight.phase != Phase.IDLE) endFlight()
        recordings.list().forEach { it.file.delete() }
        recordings.empty()
    }

    /** Lets a moment pass, for the main thread and for others. */
    fun pass(ms: Long = 20) {
        Thread.sleep(ms)
        // First: a service does not end with a start that it has not been given.
        while (true) {
            val intent = shadowOf(app).nextStartedService ?: break
            started += intent
            if (intent.component == ComponentName(app, FlightService::class.java)) deliver(intent)
        }
        shadowOf(Looper.getMainLooper()).idleFor(Duration.ofMillis(ms))
        service?.takeIf { shadowOf(it.get()).isStoppedBySelf }?.let {
            service = null
            it.destroy()
        }
    }

    /** Gives the service an intent, null as after it was killed. */
    fun deliver(intent: Intent?) {
        val service = service ?: Robolectric.buildService(FlightService::class.java).create().also { service = it }
        starts += 1
        service.get().onStartCommand(intent, 0, starts)
    }

    /** Ends the service as the system does, and not as it does itself. */
    fun destroyService() {
        service?.destroy()
        service = null
    }

    /** Waits until something holds, for 20 s. */
    fun eventually(what: String, holds: () -> Boolean) {
        repeat(1_000) {
            if (holds()) return
            pass()
        }
        val state = Flight.state()
        val now = state.now
        fail(
            "not within 20 s: $what; ${state.phase} ${now?.state} ${state.ending}; " +
                "inhibited by ${now?.engageInhibits}; ${state.reports.takeLast(8)}",
        )
    }

    /** Asks for a flight without a screen. */
    fun start(config: String) {
        Configuration(app).save(config)
        FlightService.start(app)
    }

    /** Begins a flight without a screen, and waits until it can be engaged. */
    fun fly(config: String = FLOWN) {
        start(config)
        eventually("ready to engage") { tick()?.engageInhibits?.isEmpty() == true }
    }

    /** Ends the flight, and waits for its service to end. */
    fun endFlight() {
        FlightService.stop(app)
        eventually("it has ended") { Flight.phase == Phase.IDLE && service == null }
    }

    /** Begins a calibration on the screen *connect*, which is in front. */
    fun beginCalibration(activity: Activity, kind: String) {
        val offers = activity.findViewById<ViewGroup>(R.id.calibrations)
        eventually("offered") { "Calibrate: $kind" in offers.allWords() }
        val buttons = (0 until offers.childCount).map { offers.getChildAt(it) as Button }
        buttons.single { it.text == "Calibrate: $kind" }.performClick()
        eventually("it is guided") { activity.findViewById<View>(R.id.calibration_cancel).isShown }
    }

    fun tick() = Flight.state().takeIf { it.phase == Phase.FLYING }?.now

    fun isIn(state: String) = tick()?.state == state

    /** The notification that the service shows. */
    fun notification(): Notification? {
        val manager = app.getSystemService(NotificationManager::class.java)
        return shadowOf(manager).getNotification(FlightNotification.ID)
    }

    fun notificationWords(): String = notification()?.extras?.let {
        "${it.getCharSequence(Notification.EXTRA_TITLE)} / ${it.getCharSequence(Notification.EXTRA_TEXT)}"
    }.orEmpty()
}

/** Touches a view as a finger does: one that is hidden or disabled does nothing. */
fun Activity.touch(id: Int) {
    val view = findViewById<View>(id)
    assertTrue("not shown", view.isShown)
    if (view.isEnabled) view.performClick()
}

/** The text of a view. */
fun Activity.words(id: Int) = findViewById<TextView>(id).text.toString()

/** All text in a view, in its order. */
fun View.allWords(): List<String> = when (this) {
    is TextView -> listOf(text.toString()).filter { isShown }
    is android.view.ViewGroup -> (0 until childCount).flatMap { getChildAt(it).allWords() }
    else -> emptyList()
}

/** Puts a screen in front. */
fun MainActivity.open(screen: Int) = choose(screen)
