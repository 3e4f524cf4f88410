package fcc.android.app

import android.os.Bundle
import android.os.Parcel
import android.view.View
import android.view.ViewGroup
import android.widget.EditText
import android.widget.ListView
import fcc.android.Configuration
import fcc.android.Flight
import fcc.android.FlightService
import fcc.android.Phase
import fcc.android.R
import fcc.android.screens.MainActivity
import fcc.android.threads
import java.util.concurrent.ConcurrentLinkedQueue
import kotlin.random.Random
import org.junit.After
import org.junit.Assert.assertEquals
import org.junit.Assert.assertNotNull
import org.junit.Assert.assertTrue
import org.junit.Before
import org.junit.Rule
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.Robolectric
import org.robolectric.RobolectricTestRunner
import org.robolectric.RuntimeEnvironment
import org.robolectric.Shadows.shadowOf
import org.robolectric.annotation.Config
import org.robolectric.shadows.ShadowPowerManager

/** Someone who touches, turns and types whatever there is. */
@RunWith(RobolectricTestRunner::class)
@Config(sdk = [28, 34, 35])
class CarelessUserTest {
    @get:Rule
    val phone = Phone()
    private var controller = Robolectric.buildActivity(MainActivity::class.java)
    private val activity get() = controller.get()
    private val crashes = ConcurrentLinkedQueue<Throwable>()
    private val usual = Thread.getDefaultUncaughtExceptionHandler()

    @Before
    fun open() {
        Thread.setDefaultUncaughtExceptionHandler { _, error -> crashes += error }
        val permissions = listOf("POST_NOTIFICATIONS", "ACCESS_FINE_LOCATION", "ACCESS_COARSE_LOCATION")
        shadowOf(phone.app).grantPermissions(*permissions.map { "android.permission.$it" }.toTypedArray())
        controller.setup()
    }

    @After
    fun close() {
        controller.close()
        Thread.setDefaultUncaughtExceptionHandler(usual)
    }

    @Test
    fun `300 quick touches by seed 101`() = beCareless(101)

    @Test
    fun `300 quick touches by seed 102`() = beCareless(102)

    @Test
    fun `300 quick touches by seed 103`() = beCareless(103)

    private fun beCareless(seed: Int) {
        val random = Random(seed)
        val seen = mutableSetOf<String>()
        phone.fly()
        Flight.engage()
        phone.eventually("engaged") { phone.isIn("engaged") }
        repeat(300) { at ->
            val did = act(random)
            seen += listOfNotNull(did, "${Flight.phase}", phone.tick()?.state)
            phone.pass(random.nextLong(30))
            val what = "seed $seed, $at: $did"
            assertEquals(what, emptyList<Throwable>(), crashes.toList())
            val isAsked = Flight.phase == Phase.BEGINNING || Flight.phase == Phase.FLYING
            if (isAsked) assertNotNull("$what: it flies unseen", phone.notification())
        }
        val tabs = listOf("connect", "fly", "recordings", "settings").map { "touched tab_$it" }
        assertTrue("$seen", seen.containsAll(tabs))
        // Whatever flies is ended by its notification, with no screen there.
        controller.close()
        phone.eventually("it has begun") { Flight.phase != Phase.BEGINNING }
        phone.notification()?.actions?.single()?.actionIntent?.send()
        phone.eventually("nothing flies") { Flight.phase == Phase.IDLE && phone.service == null }
        phone.eventually("no loop is left: ${threads()}") { "fcc-loop" !in threads() }
        assertTrue(ShadowPowerManager.getLatestWakeLock()?.isHeld != true)
        assertEquals(emptyList<String>(), phone.recordings.list().filter { it.wholeness != "whole" }.map { "${it.error}" })
        assertEquals(emptyList<Throwable>(), crashes.toList())
        controller = Robolectric.buildActivity(MainActivity::class.java).setup()
    }

    /** Does something; what it was. */
    private fun act(random: Random): String = when (random.nextInt(100)) {
        in 0..79 -> touchAny(random)
        in 80..84 -> "two starts".also { repeat(2) { FlightService.start(phone.app) } }
        in 85..88 -> "back".also { back() }
        in 89..91 -> "made anew".also { controller.recreate() }
        in 92..94 -> "turned".also {
            RuntimeEnvironment.setQualifiers(if (random.nextBoolean()) "+land" else "+port")
            controller.recreate()
        }
        in 95..96 -> "left, and opened again".also { controller.pause().stop().restart().start().resume() }
        else -> RUBBISH.random(random).first.let { text -> "saved: $text".also { Configuration(phone.app).save(text) } }
    }

    private fun touchAny(random: Random): String {
        val views = touchable(activity.findViewById(R.id.root))
        val view = views.random(random)
        when {
            view is ListView && view.count > 0 -> {
                val at = random.nextInt(view.count)
                view.performItemClick(null, at, at.toLong())
            }
            view is EditText -> view.setText((TYPED + RUBBISH.map { it.first }).random(random))
            else -> view.performClick()
        }
        return "touched ${if (view.id > 0) activity.resources.getResourceEntryName(view.id) else view}"
    }

    private fun touchable(view: View): List<View> = when {
        !view.isShown || !view.isEnabled -> emptyList()
        view is ListView || view.hasOnClickListeners() || view is EditText -> listOf(view)
        view is ViewGroup -> (0 until view.childCount).flatMap { touchable(view.getChildAt(it)) }
        else -> emptyList()
    }

    /** Out of the app, if there is nothing else to go back to; and into it again. */
    private fun back() {
        @Suppress("DEPRECATION")
        activity.onBackPressed()
        if (!activity.isFinishing) return
        controller.close()
        controller = Robolectric.buildActivity(MainActivity::class.java).setup()
    }

    /** Each with what has to be named, as a person would look for it. */
    @Test
    fun `rubbish is refused with fccd's words, and nothing flies by it`() {
        for ((text, named) in RUBBISH) {
            activity.open(MainActivity.SETTINGS)
            activity.findViewById<EditText>(R.id.text).setText(text)
            activity.touch(R.id.check)
            phone.eventually("checked") { activity.words(R.id.message) !in listOf("Checking…", "Not saved.") }
            val message = activity.words(R.id.message)
            val what = "${text.take(40)}: ${message.take(400)}"
            assertTrue(what, named in message)
            assertTrue(what, listOf("Exception", "fcc.android", "an error of the program").none { it in message })
            // As if it had been saved by an earlier version.
            Configuration(phone.app).save(text)
            activity.open(MainActivity.FLY)
            phone.eventually("it may be started") { activity.words(R.id.engage) == "Start" }
            phone.pass(600)
            activity.touch(R.id.engage)
            phone.eventually("refused") { message in activity.words(R.id.problem) && phone.service == null }
            assertEquals(what, Phase.IDLE, Flight.phase)
        }
        assertEquals(emptyList<String>(), phone.recordings.list().map { it.file.name })
        assertEquals(emptyList<Throwable>(), crashes.toList())
    }

    /** Android's `TransactionTooLargeException`: all of an app's calls share a buffer of 1 MB. */
    @Test
    fun `a text that is too long is not entered, and what is kept fits`() {
        activity.open(MainActivity.SETTINGS)
        val text = activity.findViewById<EditText>(R.id.text)
        text.text.append("#".repeat(1_000_000))
        phone.eventually("said") { activity.words(R.id.message).startsWith("Not entered") }
        assertEquals(FLOWN, text.text.toString())
        text.setText("#".repeat(100_000))
        assertEquals(100_000, text.length())
        val kept = Bundle()
        controller.saveInstanceState(kept)
        val parcel = Parcel.obtain()
        parcel.writeBundle(kept)
        assertTrue("${parcel.dataSize()}", parcel.dataSize() in 100_000..500_000)
        parcel.recycle()
    }

    private companion object {
        val TYPED = listOf(FLOWN, BY_PHONE, "", "#")

        val RUBBISH = listOf(
            "" to "configuration",
            "\u0000" to "configuration:1",
            "\uD800" to "configuration:1",
            "\uFEFF\uFEFF[built-in]" to "configuration:1",
            "<html><body>404</body></html>" to "configuration:1",
            "PK\u0003\u0004\u0014" to "configuration:1",
            "[built-in" to "configuration:1",
            "[built-in]\n[built-in]\n" to "configuration:2",
            "[built-in]\nno such key = 1\n" to "configuration:2",
            "[built-in]\ncolour = \"red\"\n" to "colour",
            "[built-in]\n[loop]\nrate_hz = nan\n" to "loop.rate_hz",
            "[built-in]\n[loop]\nrate_hz = 1e300\n" to "loop.rate_hz",
            "[built-in]\n[loop]\nrate_hz = \"fast\"\n" to "rate_hz",
            "[built-in]\n[loop]\nrate_hz = 99999999999999999999999999\n" to "configuration:3",
            "[built-in]\naltitude_ft = -1e9\n" to "altitude_ft",
            "[x-plane]\nsimulator = \"\"\n" to "simulator",
            "[x-plane]\nsimulator = \"127.0.0.1:99999\"\n" to "simulator",
            "[[sensor]]\nkind = \"astrology\"\n" to "astrology",
            "[built-in]\n[guidance]\nmode = \"loop the loop\"\n" to "mode",
            "a = " + "[".repeat(50_000) to "configuration:1",
        )
    }
}
