package fcc.android

import android.app.Notification
import android.app.NotificationChannel
import android.app.NotificationManager
import android.app.PendingIntent
import android.app.Service
import android.content.Intent
import android.os.Build
import fcc.android.screens.MainActivity
import fcc.android.screens.silence
import fcc.android.screens.words

/** The notification of a flight: its state, and an action that ends it. */
class FlightNotification(private val service: Service) {
    private val manager = service.getSystemService(NotificationManager::class.java)
    private val since = System.currentTimeMillis()
    private var shown: Pair<String, String>? = null

    init {
        // Without a sound: it is there for as long as something flies.
        val channel = NotificationChannel(
            CHANNEL,
            service.getString(R.string.channel_name),
            NotificationManager.IMPORTANCE_LOW,
        )
        channel.description = service.getString(R.string.channel_description)
        channel.setShowBadge(false)
        manager.createNotificationChannel(channel)
    }

    /** Of a flight of which nothing is known yet. */
    fun of(phase: Phase): Notification = build(service.getString(phase.words), "")

    /** Shows a state, if it is not the one shown. */
    fun show(state: FlightState) {
        val words = titleOf(state) to textOf(state)
        if (words == shown) return
        shown = words
        manager.notify(ID, build(words.first, words.second))
    }

    private fun titleOf(state: FlightState): String {
        val now = state.now
        return if (state.phase == Phase.FLYING && now != null) words(service, now) else service.getString(state.phase.words)
    }

    private fun textOf(state: FlightState): String {
        val now = state.now ?: return state.ending.orEmpty()
        return when {
            now.faults.isNotEmpty() -> now.faults.joinToString()
            now.hasControl -> now.mode
            now.isSilent -> service.silence(state)
            now.engageInhibits.isNotEmpty() ->
                service.getString(R.string.inhibited, now.engageInhibits.joinToString())
            else -> service.getString(R.string.ready)
        }
    }

    private fun build(title: String, text: String): Notification {
        val screen = PendingIntent.getActivity(
            service,
            0,
            Intent(service, MainActivity::class.java),
            PendingIntent.FLAG_IMMUTABLE,
        )
        val stop = PendingIntent.getService(
            service,
            0,
            Intent(service, FlightService::class.java).setAction(FlightService.STOP),
            PendingIntent.FLAG_IMMUTABLE,
        )
        val builder = Notification.Builder(service, CHANNEL)
            .setSmallIcon(R.drawable.notification)
            .setContentTitle(title)
            .setContentText(text)
            .setStyle(Notification.BigTextStyle().bigText(text))
            .setContentIntent(screen)
            .setOngoing(true)
            .setOnlyAlertOnce(true)
            .setUsesChronometer(true)
            .setWhen(since)
            .setCategory(Notification.CATEGORY_SERVICE)
            .setVisibility(Notification.VISIBILITY_PUBLIC)
            .addAction(Notification.Action.Builder(null, service.getString(R.string.end_flight), stop).build())
        if (Build.VERSION.SDK_INT >= Build.VERSION_CODES.S) {
            builder.setForegroundServiceBehavior(Notification.FOREGROUND_SERVICE_IMMEDIATE)
        }
        return builder.build()
    }

    companion object {
        const val ID = 1
        private const val CHANNEL = "flight"
    }
}
