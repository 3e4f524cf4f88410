package fcc.android

import android.content.ContentProvider
import android.content.ContentValues
import android.content.Context
import android.content.Intent
import android.database.Cursor
import android.database.MatrixCursor
import android.net.Uri
import android.os.ParcelFileDescriptor
import android.provider.OpenableColumns
import java.io.File
import java.io.FileNotFoundException

/** Gives a recording to the app that the user shares it with, to read, and nothing else. */
class RecordingProvider : ContentProvider() {
    override fun onCreate() = true

    override fun openFile(uri: Uri, mode: String): ParcelFileDescriptor {
        if (mode != "r") throw FileNotFoundException("$uri: may only be read")
        return ParcelFileDescriptor.open(fileOf(uri), ParcelFileDescriptor.MODE_READ_ONLY)
    }

    override fun query(
        uri: Uri,
        projection: Array<String>?,
        selection: String?,
        selectionArgs: Array<String>?,
        sortOrder: String?,
    ): Cursor? {
        val file = try {
            fileOf(uri)
        } catch (_: FileNotFoundException) {
            return null
        }
        val values = mapOf(OpenableColumns.DISPLAY_NAME to file.name, OpenableColumns.SIZE to file.length())
        val columns = (projection ?: values.keys.toTypedArray()).filter { it in values }
        return MatrixCursor(columns.toTypedArray(), 1).apply { addRow(columns.map { values[it] }) }
    }

    override fun getType(uri: Uri) = TYPE

    /** A name without a folder in it, of a recording that is there. */
    private fun fileOf(uri: Uri): File {
        val name = uri.pathSegments.singleOrNull()
        val folder = Recordings.folder(context ?: throw FileNotFoundException("$uri"))
        val file = folder.listFiles()?.find { it.name == name && it.isFile && it.extension == EXTENSION }
        return file ?: throw FileNotFoundException("$uri: no such recording")
    }

    override fun insert(uri: Uri, values: ContentValues?): Uri? = null

    override fun update(uri: Uri, values: ContentValues?, where: String?, args: Array<String>?) = 0

    override fun delete(uri: Uri, where: String?, args: Array<String>?) = 0

    companion object {
        private const val AUTHORITY = "fcc.android.recordings"
        private const val EXTENSION = "mcap"
        private const val TYPE = "application/octet-stream"

        /** What shares a recording with an app that the user chooses. */
        fun share(context: Context, file: File): Intent {
            val uri = Uri.Builder().scheme("content").authority(AUTHORITY).appendPath(file.name).build()
            val send = Intent(Intent.ACTION_SEND)
                .setType(TYPE)
                .putExtra(Intent.EXTRA_STREAM, uri)
                .putExtra(Intent.EXTRA_SUBJECT, file.name)
                .addFlags(Intent.FLAG_GRANT_READ_URI_PERMISSION)
            // The permission is that of the clip.
            send.clipData = android.content.ClipData.newUri(context.contentResolver, file.name, uri)
            return Intent.createChooser(send, file.name).addFlags(Intent.FLAG_GRANT_READ_URI_PERMISSION)
        }
    }
}
