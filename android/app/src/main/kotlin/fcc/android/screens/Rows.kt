package fcc.android.screens

import android.view.LayoutInflater
import android.view.View
import android.view.ViewGroup
import android.widget.TextView
import fcc.android.R

/** A line of a table. */
data class Row(val label: String, val value: String = "", val tone: Tone = Tone.PLAIN)

/** What a line means. */
enum class Tone(val color: Int) {
    PLAIN(R.color.text),
    DIM(R.color.text_dim),
    GOOD(R.color.good),
    BAD(R.color.bad),
}

/** A text, if it is not the one shown: a screen reader reads a change. */
internal fun TextView.show(text: String) {
    if (this.text.toString() != text) this.text = text
}

/** Shows a view, or takes its room away. */
internal fun View.showIf(isShown: Boolean) {
    visibility = if (isShown) View.VISIBLE else View.GONE
}

/** Fills a table: views are made once, and only what changed is drawn. */
internal class Rows(private val table: ViewGroup) {
    private var shown = emptyList<Row>()

    fun show(rows: List<Row>) {
        if (rows == shown) return
        shown = rows
        val inflater = LayoutInflater.from(table.context)
        while (table.childCount < rows.size) inflater.inflate(R.layout.row, table)
        for (at in 0 until table.childCount) {
            val view = table.getChildAt(at)
            val row = rows.getOrNull(at)
            view.showIf(row != null)
            if (row == null) continue
            view.findViewById<TextView>(R.id.row_label).apply {
                show(row.label)
                setTextColor(context.getColor(row.tone.color))
            }
            view.findViewById<TextView>(R.id.row_value).apply {
                show(row.value)
                showIf(row.value.isNotEmpty())
                setTextColor(context.getColor(row.tone.color))
            }
        }
    }

    /** Lines of text. */
    fun show(lines: List<String>, otherwise: String) =
        show(lines.ifEmpty { listOf(otherwise) }.map { Row(it, tone = if (lines.isEmpty()) Tone.DIM else Tone.PLAIN) })
}
