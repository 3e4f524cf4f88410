package fcc.android

import android.content.Context
import android.util.AtomicFile
import java.io.File
import java.io.FileNotFoundException
import java.io.IOException

/** The configuration that is flown: a text in the app's folder, or else the example. */
class Configuration(private val context: Context) {
    private val file = File(context.filesDir, "fccd.toml")

    /** The text; the built-in aircraft's before one is saved. */
    fun text(): String = try {
        synchronized(FILE) { String(AtomicFile(file).readFully()) }
    } catch (_: FileNotFoundException) {
        example(R.raw.example_built_in)
    }

    /** One of the examples of `res/raw`. */
    fun example(resource: Int): String =
        context.resources.openRawResource(resource).use { String(it.readBytes()) }

    /**
     * What the library says of a text; null if it can be flown. Not for the thread
     * that draws.
     */
    fun problems(text: String): String? = try {
        FlightComputer(text, Recordings.folder(context)).close()
        null
    } catch (error: FccException) {
        error.message.orEmpty()
    }

    /**
     * Saves a text, wholly or not at all.
     *
     * @throws IOException if there is no room for it.
     */
    fun save(text: String) = synchronized(FILE) {
        val atomic = AtomicFile(file)
        val stream = atomic.startWrite()
        try {
            stream.write(text.toByteArray())
            atomic.finishWrite(stream)
        } catch (error: IOException) {
            atomic.failWrite(stream)
            throw error
        }
    }

    companion object {
        /** Who reads an [AtomicFile] deletes what is being written, and the writer is not told. */
        private val FILE = Any()

        private val LINE = Regex("""\bconfiguration:(\d+)""")

        /** In a table of its own, or in a list: `sensor = [{ kind = "phone" }]`. */
        private val PHONE = Regex("""^[^#\n]*\bkind["']?\s*=\s*["']+phone["']""", RegexOption.MULTILINE)

        /** The first line that a message names, from 1. */
        fun lineOf(message: String): Int? = LINE.find(message)?.groupValues?.get(1)?.toInt()

        /**
         * Whether a text has the phone's sensors, and so its positions. The library
         * knows better, and a permission asked for in vain does no harm.
         */
        fun usesPhone(text: String) = PHONE.containsMatchIn(text)
    }
}
