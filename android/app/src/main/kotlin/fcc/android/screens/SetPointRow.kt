package fcc.android.screens

import android.os.SystemClock
import android.view.View
import android.widget.Button
import android.widget.TextView
import fcc.android.Commands
import fcc.android.R

/** A quantity that can be set: how it is shown, and by how much a step changes it. */
internal class Quantity(
    val label: Int,
    /** Its set point in android/README.md. */
    val setPoint: String,
    val step: Double,
    val format: (Double) -> String,
    /** Brings a stepped value to where it belongs. */
    val round: (Double) -> Double,
)

/** A quantity beside its set point, with a button for less and one for more. */
internal class SetPointRow(private val view: View, private val refused: (String) -> Unit) {
    private val label: TextView = view.findViewById(R.id.label)
    private val value: TextView = view.findViewById(R.id.value)
    private val setPoint: TextView = view.findViewById(R.id.set_point)
    private val less: Button = view.findViewById(R.id.less)
    private val more: Button = view.findViewById(R.id.more)
    private var quantity: Quantity? = null
    private var desired: Double? = null

    /** What was asked for and is not shown by the loop yet: the next step is from here. */
    private var asked: Double? = null
    private var askedAtMs = 0L

    init {
        less.setOnClickListener { step(-1) }
        more.setOnClickListener { step(1) }
    }

    /** Shows a value and its set point; null is not known, or not controlled. */
    fun show(quantity: Quantity, now: Double?, desired: Double?) {
        if (quantity.setPoint != this.quantity?.setPoint) describe(quantity)
        this.quantity = quantity
        this.desired = desired
        if (SystemClock.uptimeMillis() - askedAtMs > ASKED_FOR_MS) asked = null
        val context = view.context
        value.show(now?.let(quantity.format) ?: context.getString(R.string.unknown))
        val shown = asked?.takeIf { desired != null } ?: desired
        setPoint.show(
            shown?.let { context.getString(R.string.set_point, quantity.format(it)) }
                ?: context.getString(R.string.no_set_point),
        )
        less.isEnabled = desired != null
        more.isEnabled = desired != null
    }

    private fun describe(quantity: Quantity) {
        val context = view.context
        val name = context.getString(quantity.label)
        label.show(name)
        val step = quantity.format(quantity.step)
        less.contentDescription = context.getString(R.string.less, name, step)
        more.contentDescription = context.getString(R.string.more, name, step)
    }

    private fun step(direction: Int) {
        val quantity = quantity ?: return
        val from = asked ?: desired ?: return
        val next = quantity.round(from + direction * quantity.step)
        asked = next
        askedAtMs = SystemClock.uptimeMillis()
        Commands.set(quantity.setPoint, next) { why ->
            asked = null
            refused(why)
        }
    }

    private companion object {
        /** Longer than a tick and two of the screen's states take. */
        const val ASKED_FOR_MS = 1_000L
    }
}
