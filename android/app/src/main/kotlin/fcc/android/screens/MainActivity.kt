package fcc.android.screens

import android.Manifest
import android.app.Activity
import android.content.pm.PackageManager
import android.os.Build
import android.os.Bundle
import android.view.View
import android.view.WindowInsets
import android.widget.FrameLayout
import fcc.android.Configuration
import fcc.android.Flight
import fcc.android.FlightService
import fcc.android.FlightState
import fcc.android.Phase
import fcc.android.Positions
import fcc.android.R
import fcc.android.Recordings
import fcc.android.StatePoller

/** The app's only activity: four screens, of which one is in front. The flight is not its own. */
class MainActivity : Activity() {
    private lateinit var screens: List<Screen>
    private lateinit var tabs: List<View>
    private val poller = StatePoller(DRAWN_EVERY_MS, Flight::state) { show(it) }
    private var chosen = FLY
    private var isStarted = false

    override fun onCreate(saved: Bundle?) {
        super.onCreate(saved)
        setContentView(R.layout.activity)
        findViewById<View>(R.id.root).setOnApplyWindowInsetsListener(::leaveRoomForSystemBars)
        screens = listOf(
            ConnectScreen(this, ::startFlight, ::endFlight),
            FlyScreen(this, ::startFlight, ::endFlight),
            RecordingsScreen(this),
            SettingsScreen(this),
        )
        val content = findViewById<FrameLayout>(R.id.content)
        screens.forEach { content.addView(it.view) }
        tabs = TABS.map { findViewById(it) }
        tabs.forEachIndexed { at, tab -> tab.setOnClickListener { choose(at) } }
        saved?.let { state ->
            chosen = state.getInt(CHOSEN)
            screens.forEach { it.restore(state) }
        }
        mark()
        Flight.releaseLeft(Recordings.folder(this)) { became ->
            runOnUiThread { if (Flight.phase == Phase.IDLE) Flight.refuse(getString(R.string.left_held, became)) }
        }
    }

    override fun onStart() {
        super.onStart()
        isStarted = true
        screens[chosen].enter()
        poller.start()
    }

    override fun onStop() {
        poller.stop()
        screens[chosen].leave()
        isStarted = false
        super.onStop()
    }

    override fun onSaveInstanceState(state: Bundle) {
        super.onSaveInstanceState(state)
        state.putInt(CHOSEN, chosen)
        screens.forEach { it.save(state) }
    }

    @Deprecated("As long as the app is for Android 15")
    override fun onBackPressed() {
        @Suppress("DEPRECATION")
        if (!screens[chosen].back()) super.onBackPressed()
    }

    /** Puts a screen in front. */
    internal fun choose(screen: Int) {
        if (screen == chosen) return
        screens[chosen].leave()
        chosen = screen
        mark()
        if (isStarted) screens[chosen].enter()
    }

    private fun mark() {
        screens.forEachIndexed { at, screen -> screen.view.showIf(at == chosen) }
        tabs.forEachIndexed { at, tab -> tab.isSelected = at == chosen }
    }

    private fun show(state: FlightState) = screens[chosen].show(state)

    /** Asks for the permissions that the flight has a use for, and flies with or without them. */
    private fun startFlight() {
        val config = Configuration(this).text()
        val wanted = listOfNotNull(
            Manifest.permission.POST_NOTIFICATIONS
                .takeIf { Build.VERSION.SDK_INT >= Build.VERSION_CODES.TIRAMISU },
            Manifest.permission.ACCESS_FINE_LOCATION.takeIf { Configuration.usesPhone(config) },
        ).filter { checkSelfPermission(it) != PackageManager.PERMISSION_GRANTED }
        if (wanted.isEmpty()) {
            FlightService.start(this)
        } else {
            // Android 12 asks for both kinds of location together.
            val coarse = listOf(Manifest.permission.ACCESS_COARSE_LOCATION)
                .filter { Manifest.permission.ACCESS_FINE_LOCATION in wanted }
            requestPermissions((wanted + coarse).toTypedArray(), PERMISSIONS)
        }
    }

    override fun onRequestPermissionsResult(request: Int, permissions: Array<String>, results: IntArray) {
        // Empty if the question was interrupted, as by turning the phone.
        if (request != PERMISSIONS || permissions.isEmpty()) return
        FlightService.start(this)
        screens[chosen].enter()
    }

    private fun endFlight() = FlightService.stop(this)

    private fun leaveRoomForSystemBars(view: View, insets: WindowInsets): WindowInsets {
        if (Build.VERSION.SDK_INT >= Build.VERSION_CODES.R) {
            val bars = insets.getInsets(
                WindowInsets.Type.systemBars() or WindowInsets.Type.displayCutout() or WindowInsets.Type.ime(),
            )
            view.setPadding(bars.left, bars.top, bars.right, bars.bottom)
            return WindowInsets.CONSUMED
        }
        @Suppress("DEPRECATION")
        with(insets) {
            view.setPadding(
                systemWindowInsetLeft, systemWindowInsetTop, systemWindowInsetRight, systemWindowInsetBottom,
            )
            return consumeSystemWindowInsets()
        }
    }

    internal companion object {
        const val CONNECT = 0
        const val FLY = 1
        const val RECORDINGS = 2
        const val SETTINGS = 3
        private val TABS = listOf(R.id.tab_connect, R.id.tab_fly, R.id.tab_recordings, R.id.tab_settings)
        private const val CHOSEN = "chosen screen"
        private const val PERMISSIONS = 1
        private const val DRAWN_EVERY_MS = 50L
    }
}
