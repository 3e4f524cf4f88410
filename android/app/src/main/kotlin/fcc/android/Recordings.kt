package fcc.android

import android.content.Context
import java.io.File
import org.json.JSONArray
import org.json.JSONObject

/** A file in the folder of recordings. */
class RecordingEntry(entry: JSONObject) {
    /** Of which nothing is known but the file. */
    constructor(file: File) : this(JSONObject().put("path", file.path))

    val file = File(entry.getString("path"))

    /** When the flight began, in UTC: `2026-11-20T04:21:33Z`; empty if it cannot be read. */
    val started: String = entry.optString("started")
    val plant: String = entry.optString("plant")
    val part = entry.optInt("part", 1)
    val durationS = entry.optDouble("duration_s", 0.0)
    val ticks = entry.optLong("ticks")
    val ending: String = entry.optString("ending")
    val notRecorded = entry.optLong("not_recorded")

    /** `whole`, `damaged`, `cut` or `being-written`. */
    val wholeness: String = entry.optString("file")

    /** Why it cannot be read. */
    val error = entry.text("error")

    /** Of the flight that goes on: neither shared nor deleted. */
    val isBeingWritten get() = wholeness == "being-written" || STILL_WRITTEN in error.orEmpty()

    private companion object {
        /** Of one that has just begun, in which there is nothing to read yet. */
        const val STILL_WRITTEN = "still being written"
    }
}

/** What a report says on a recording. */
class RecordingReport(report: JSONObject) {
    val findings = report.texts("findings")
    val timing = report.optJSONObject("timing")?.let(::Timing)
    val events =
        report.objects("events").map { "%.1f s: %s".format(it.optDouble("time_s"), it.optString("text")) }
}

/**
 * The recordings in the app's folder. What is deleted has another name until [empty], and
 * can be restored. None of it is for the thread that draws.
 */
class Recordings(private val folder: File) {
    /**
     * All of them, the newest first.
     *
     * @throws RecordingException if the folder cannot be read.
     */
    fun list(): List<RecordingEntry> =
        FlightComputer(ANY_CONFIGURATION, folder).use { JSONArray(it.recordings()) }
            .objects()
            .map(::RecordingEntry)
            .reversed()

    /**
     * Reads a recording, and reports on it.
     *
     * @throws RecordingException if it cannot be read.
     */
    fun report(file: File) = RecordingReport(JSONObject(FlightComputer.report(file)))

    /** The recording of this name, there or not. */
    fun fileOf(name: String) = File(folder, name)

    /**
     * Whether it is deleted, until it is restored; not what a flight writes, whatever it was
     * when it was listed: the flight would lose what is in it.
     *
     * @throws RecordingException if the folder cannot be read.
     */
    fun delete(file: File): Boolean = !isBeingWritten(file) && file.renameTo(asDeleted(file))

    private fun isBeingWritten(file: File) =
        (Flight.phase != Phase.IDLE && Flight.state().recording?.file == file.path) ||
            list().any { it.file == file && it.isBeingWritten }

    /** Whether what was deleted is there again. */
    fun restore(file: File): Boolean = asDeleted(file).renameTo(file)

    /** Deletes for good. */
    fun empty() {
        folder.listFiles()?.filter { it.name.endsWith(DELETED) }?.forEach { it.delete() }
    }

    /** In the same folder: a full disk has no room for another one. */
    private fun asDeleted(file: File) = File(file.path + DELETED)

    companion object {
        private const val DELETED = ".deleted"

        /** To list files needs none of the user's. */
        private const val ANY_CONFIGURATION = "[built-in]\n"

        /** The folder; the app's own, which needs no permission. */
        fun folder(context: Context) = File(context.filesDir, "recordings")
    }
}
