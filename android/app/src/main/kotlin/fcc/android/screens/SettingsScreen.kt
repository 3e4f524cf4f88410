package fcc.android.screens

import android.app.Activity
import android.os.Bundle
import android.text.Editable
import android.text.InputFilter
import android.text.TextWatcher
import android.view.View
import android.widget.Button
import android.widget.EditText
import android.widget.TextView
import fcc.android.Configuration
import fcc.android.FlightState
import fcc.android.R
import java.io.IOException
import java.util.concurrent.Executors

/** The configuration as text: checked by the library, and saved only if it can be flown. */
internal class SettingsScreen(private val activity: Activity) : Screen {
    override val view: View = activity.layoutInflater.inflate(R.layout.settings, null)
    private val text: EditText = view.findViewById(R.id.text)
    private val message: TextView = view.findViewById(R.id.message)
    private val save: Button = view.findViewById(R.id.save)
    private val discard: Button = view.findViewById(R.id.discard)
    private val configuration = Configuration(activity)
    private var saved = configuration.text()

    init {
        text.setText(saved)
        text.addTextChangedListener(object : TextWatcher {
            override fun beforeTextChanged(text: CharSequence?, start: Int, count: Int, after: Int) = Unit

            override fun onTextChanged(text: CharSequence?, start: Int, before: Int, count: Int) = Unit

            override fun afterTextChanged(text: Editable?) = showWhetherChanged()
        })
        text.filters = arrayOf(InputFilter(::orTooLong))
        view.findViewById<Button>(R.id.check).setOnClickListener { check(andSave = false) }
        save.setOnClickListener { check(andSave = true) }
        discard.setOnClickListener { text.setText(saved) }
        for ((button, example) in EXAMPLES) {
            view.findViewById<Button>(button).setOnClickListener { text.setText(configuration.example(example)) }
        }
        showWhetherChanged()
        lookAgain()
    }

    /** What is saved once an activity before this one, made anew meanwhile, has saved. */
    private fun lookAgain() = checking.execute {
        val now = configuration.text()
        activity.runOnUiThread {
            if (!activity.isDestroyed && now != saved) {
                saved = now
                showWhetherChanged()
            }
        }
    }

    override fun show(state: FlightState) = Unit

    override fun save(state: Bundle) = state.putString(TEXT, text.text.toString())

    override fun restore(state: Bundle) {
        state.getString(TEXT)?.let(text::setText)
    }

    /** As [InputFilter.filter]: null to take what is entered, or else what was there. */
    private fun orTooLong(
        entered: CharSequence,
        start: Int,
        end: Int,
        text: CharSequence,
        removedAt: Int,
        removedTo: Int,
    ): CharSequence? {
        val added = (end - start) - (removedTo - removedAt)
        if (added <= 0 || text.length + added <= MOST_CHARACTERS) return null
        // After what the text that is as it was says.
        view.post { say(activity.getString(R.string.configuration_too_long, MOST_CHARACTERS), Tone.BAD) }
        return text.subSequence(removedAt, removedTo)
    }

    private fun showWhetherChanged() {
        val isChanged = text.text.toString() != saved
        save.isEnabled = isChanged
        discard.isEnabled = isChanged
        say(activity.getString(if (isChanged) R.string.configuration_changed else R.string.configuration_saved))
    }

    private fun check(andSave: Boolean) {
        val checked = text.text.toString()
        say(activity.getString(R.string.configuration_checking))
        checking.execute {
            val problems = configuration.problems(checked)
            val notSaved = if (andSave && problems == null) write(checked) else null
            activity.runOnUiThread {
                when {
                    activity.isDestroyed -> Unit
                    problems != null -> showProblems(problems)
                    notSaved != null -> say(notSaved, Tone.BAD)
                    andSave -> showSaved(checked)
                    else -> showValid(checked)
                }
            }
        }
    }

    private fun write(checked: String): String? = try {
        configuration.save(checked)
        null
    } catch (error: IOException) {
        activity.getString(R.string.configuration_not_saved, error.message.orEmpty())
    }

    private fun showSaved(checked: String) {
        saved = checked
        showWhetherChanged()
        if (text.text.toString() == checked) showValid(checked)
    }

    private fun showValid(checked: String) {
        val words = if (checked == saved) R.string.configuration_valid_saved else R.string.configuration_valid
        say(activity.getString(words), Tone.GOOD)
    }

    /** With the first line that a problem names selected. */
    private fun showProblems(problems: String) {
        say(problems, Tone.BAD)
        val line = Configuration.lineOf(problems) ?: return
        val lines = text.text.toString().split("\n")
        val start = lines.take(line - 1).sumOf { it.length + 1 }.coerceAtMost(text.length())
        val end = (start + lines.getOrElse(line - 1) { "" }.length).coerceAtMost(text.length())
        text.requestFocus()
        text.setSelection(start, end)
    }

    private fun say(words: String, tone: Tone = Tone.PLAIN) {
        message.show(words)
        message.setTextColor(activity.getColor(tone.color))
    }

    private companion object {
        const val TEXT = "edited configuration"

        /** Android ends an app whose saved state does not pass through a buffer of 1 MB. */
        const val MOST_CHARACTERS = 100_000
        val EXAMPLES = listOf(
            R.id.example_built_in to R.raw.example_built_in,
            R.id.example_x_plane to R.raw.example_x_plane,
            R.id.example_phone to R.raw.example_phone,
        )
        val checking = Executors.newSingleThreadExecutor { Thread(it, "check") }
    }
}
