package fcc.android.screens

import android.app.Activity
import android.os.Bundle
import android.view.View
import android.widget.Button
import android.widget.ListView
import android.widget.TextView
import fcc.android.FccException
import fcc.android.FlightState
import fcc.android.Phase
import fcc.android.R
import fcc.android.RecordingEntry
import fcc.android.RecordingProvider
import fcc.android.RecordingReport
import fcc.android.Recordings
import java.util.concurrent.Executors

/** The recordings: a list, a summary of each, and what can be done with it. */
internal class RecordingsScreen(private val activity: Activity) : Screen {
    override val view: View = activity.layoutInflater.inflate(R.layout.recordings, null)
    private val message: TextView = view.findViewById(R.id.recordings_message)
    private val list: ListView = view.findViewById(R.id.list)
    private val details: View = view.findViewById(R.id.details)
    private val actions: View = view.findViewById(R.id.actions)
    private val share: Button = view.findViewById(R.id.share)
    private val delete: Button = view.findViewById(R.id.delete)
    private val undoBar: View = view.findViewById(R.id.undo_bar)
    private val deletedText: TextView = view.findViewById(R.id.deleted)
    private val summary = Rows(view.findViewById(R.id.summary))
    private val timing = Rows(view.findViewById(R.id.recording_timing))
    private val events = Rows(view.findViewById(R.id.recording_events))
    private val adapter = RecordingAdapter(activity)

    private val recordings = Recordings(Recordings.folder(activity))
    private var chosen: RecordingEntry? = null

    /** The name of the one that is to be chosen when the list is read. */
    private var chosenName: String? = null
    private var deleted: RecordingEntry? = null
    private var phase: Phase? = null
    private var isInFront = false

    init {
        list.adapter = adapter
        list.setOnItemClickListener { _, _, at, _ -> choose(adapter.getItem(at)) }
        view.findViewById<Button>(R.id.back).setOnClickListener { close() }
        share.setOnClickListener {
            chosen?.let { activity.startActivity(RecordingProvider.share(activity, it.file)) }
        }
        delete.setOnClickListener { chosen?.let(::delete) }
        view.findViewById<Button>(R.id.undo).setOnClickListener { undo() }
    }

    override fun enter() {
        isInFront = true
        read()
    }

    /** What was deleted and not restored is gone when the screen is left. */
    override fun leave() {
        isInFront = false
        if (activity.isChangingConfigurations) return
        deleted = null
        undoBar.showIf(false)
        reading.execute { recordings.empty() }
    }

    override fun show(state: FlightState) {
        if (phase != null && phase != state.phase && isInFront) read()
        phase = state.phase
    }

    override fun back(): Boolean {
        if (chosen == null) return false
        close()
        return true
    }

    override fun save(state: Bundle) {
        state.putString(CHOSEN, chosen?.file?.name)
        state.putString(DELETED, deleted?.file?.name)
    }

    override fun restore(state: Bundle) {
        chosenName = state.getString(CHOSEN)
        state.getString(DELETED)?.let { name ->
            offerUndo(RecordingEntry(recordings.fileOf(name)))
        }
    }

    private fun read() {
        if (adapter.isEmpty) message.show(activity.getString(R.string.recordings_reading))
        inTheBackground({ recordings.list() }) { read ->
            adapter.show(read.getOrElse { emptyList() })
            val failure = read.exceptionOrNull()?.message
            val words = failure ?: if (adapter.isEmpty) activity.getString(R.string.recordings_none) else ""
            if (chosen == null) showMessage(words)
            chosenName?.let { name -> adapter.named(name)?.let(::choose) }
            chosenName = null
        }
    }

    private fun choose(entry: RecordingEntry) {
        chosen = entry
        summary.show(activity.linesOf(entry))
        timing.show(listOf(Row(activity.getString(R.string.recordings_reading), tone = Tone.DIM)))
        events.show(emptyList<Row>())
        val isOwn = !entry.isBeingWritten
        share.isEnabled = isOwn
        delete.isEnabled = isOwn
        showMessage(activity.titleOf(entry))
        showDetails(true)
        if (entry.error != null) return timing.show(emptyList<Row>())
        inTheBackground({ recordings.report(entry.file) }) { report ->
            if (chosen === entry) showReport(entry, report)
        }
    }

    private fun showReport(entry: RecordingEntry, report: Result<RecordingReport>) {
        val failure = report.exceptionOrNull()?.message?.let { Row(it, tone = Tone.BAD) }
        val read = report.getOrNull()
        summary.show(activity.linesOf(entry) + listOfNotNull(failure) + read?.findings.orEmpty().map { Row(it) })
        timing.show(read?.timing?.let(activity::rowsOf).orEmpty())
        events.show(read?.events.orEmpty().take(EVENTS), activity.getString(R.string.no_events))
    }

    private fun close() {
        chosen = null
        showDetails(false)
        read()
    }

    private fun showDetails(isShown: Boolean) {
        details.showIf(isShown)
        actions.showIf(isShown)
        list.showIf(!isShown)
        if (isShown) details.scrollTo(0, 0)
    }

    private fun showMessage(words: String) {
        message.show(words)
        message.showIf(words.isNotEmpty())
    }

    private fun delete(entry: RecordingEntry) {
        inTheBackground({ recordings.delete(entry.file) }) { moved ->
            if (moved.getOrDefault(false)) {
                close()
                offerUndo(entry)
            } else {
                showMessage(activity.getString(R.string.not_deleted, entry.file.name))
            }
        }
    }

    /** Until the next one is deleted, or the screen is left. */
    private fun offerUndo(entry: RecordingEntry) {
        deleted = entry
        deletedText.show(activity.getString(R.string.deleted, activity.titleOf(entry)))
        undoBar.showIf(true)
    }

    private fun undo() {
        val entry = deleted ?: return
        deleted = null
        undoBar.showIf(false)
        inTheBackground({ recordings.restore(entry.file) }) { restored ->
            read()
            if (!restored.getOrDefault(false)) {
                showMessage(activity.getString(R.string.not_restored, entry.file.name))
            }
        }
    }

    private fun <T> inTheBackground(work: () -> T, then: (Result<T>) -> Unit) {
        reading.execute {
            val result = try {
                Result.success(work())
            } catch (error: FccException) {
                Result.failure(error)
            }
            activity.runOnUiThread { if (!activity.isDestroyed) then(result) }
        }
    }

    private companion object {
        const val CHOSEN = "chosen recording"
        const val DELETED = "deleted recording"
        const val EVENTS = 200

        /** One after the other, of every activity. */
        val reading = Executors.newSingleThreadExecutor { Thread(it, "recordings") }
    }
}
