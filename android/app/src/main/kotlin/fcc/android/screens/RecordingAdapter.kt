package fcc.android.screens

import android.app.Activity
import android.content.Context
import android.view.View
import android.view.ViewGroup
import android.widget.BaseAdapter
import android.widget.TextView
import fcc.android.R
import fcc.android.RecordingEntry
import fcc.android.Timing
import java.time.Instant
import java.time.ZoneId
import java.time.format.DateTimeFormatter
import java.time.format.DateTimeParseException
import java.time.format.FormatStyle

/** The list of recordings. */
internal class RecordingAdapter(private val activity: Activity) : BaseAdapter() {
    private var shown = emptyList<RecordingEntry>()

    fun show(entries: List<RecordingEntry>) {
        shown = entries
        notifyDataSetChanged()
    }

    fun named(name: String) = shown.find { it.file.name == name }

    override fun getCount() = shown.size

    override fun getItem(position: Int) = shown[position]

    override fun getItemId(position: Int) = position.toLong()

    override fun getView(position: Int, used: View?, parent: ViewGroup): View {
        val view = used ?: activity.layoutInflater.inflate(R.layout.recording, parent, false)
        val entry = shown[position]
        view.findViewById<TextView>(R.id.title).show(activity.titleOf(entry))
        view.findViewById<TextView>(R.id.line).apply {
            show(activity.lineOf(entry))
            setTextColor(activity.getColor((if (entry.isSound) Tone.DIM else Tone.BAD).color))
        }
        return view
    }
}

private val RecordingEntry.isSound get() = wholeness == "whole" || isBeingWritten

/** When, and what flew. */
internal fun Context.titleOf(entry: RecordingEntry): String {
    if (entry.started.isEmpty()) return entry.file.name
    val title = getString(R.string.recording_title, localTime(entry.started), entry.plant)
    return if (entry.part > 1) getString(R.string.recording_part, title, entry.part) else title
}

private fun Context.lineOf(entry: RecordingEntry): String = entry.error
    ?: getString(R.string.recording_line, minutes(entry.durationS), bytes(entry.file.length()), wholeness(entry))

private fun Context.wholeness(entry: RecordingEntry): String = when (entry.wholeness) {
    "whole" -> getString(R.string.recording_whole)
    "damaged" -> getString(R.string.recording_damaged)
    "cut" -> getString(R.string.recording_cut)
    "being-written" -> getString(R.string.recording_being_written)
    else -> getString(R.string.recording_unreadable)
}

/** What is known of a recording without reading it. */
internal fun Context.linesOf(entry: RecordingEntry): List<Row> = listOfNotNull(
    Row(lineOf(entry), tone = if (entry.isSound) Tone.PLAIN else Tone.BAD),
    entry.ending.takeIf { it.isNotEmpty() }?.let { Row(it) },
    Row(entry.file.name, tone = Tone.DIM),
)

/** The timing as a table. */
internal fun Context.rowsOf(timing: Timing): List<Row> {
    fun row(label: Int, value: String) = Row(getString(label), value)
    fun ms(value: Double) = "%.3f ms".format(value)
    return listOf(
        row(R.string.timing_rate, "%.0f Hz, %s".format(timing.rateHz, timing.timer)),
        row(R.string.timing_ticks, "%d, %d".format(timing.ticks, timing.missed)),
        row(R.string.timing_mean, ms(timing.meanMs)),
        row(R.string.timing_median, ms(timing.medianMs)),
        row(R.string.timing_range, "%.3f to %s".format(timing.minMs, ms(timing.maxMs))),
        row(R.string.timing_within, "%.2f %%".format(timing.within2Percent * 100)),
        row(R.string.timing_lateness, "${duration(timing.latenessP50Us)}, ${duration(timing.latenessP99Us)}"),
        row(R.string.timing_worst, duration(timing.latenessMaxUs)),
    )
}

private fun localTime(utc: String): String = try {
    DateTimeFormatter.ofLocalizedDateTime(FormatStyle.MEDIUM, FormatStyle.SHORT)
        .withZone(ZoneId.systemDefault())
        .format(Instant.parse(utc))
} catch (_: DateTimeParseException) {
    utc
}
