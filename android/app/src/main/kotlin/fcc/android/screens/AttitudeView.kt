package fcc.android.screens

import android.content.Context
import android.graphics.Canvas
import android.graphics.Paint
import android.graphics.Path
import android.util.AttributeSet
import android.view.View
import fcc.android.R
import kotlin.math.abs
import kotlin.math.min
import kotlin.math.roundToInt

/**
 * An attitude indicator: the horizon as the pilot sees it, a pitch ladder in steps
 * of 10 degrees, and a roll scale. A cross, if the attitude is not known.
 */
class AttitudeView(context: Context, attributes: AttributeSet?) : View(context, attributes) {
    private var rollDeg = 0f
    private var pitchDeg = 0f
    private var isKnown = false

    private val sky = filled(R.color.sky)
    private val ground = filled(R.color.ground)
    private val unknown = filled(R.color.instrument_unknown)
    private val line = stroked(R.color.instrument_line, 2f)
    private val aircraft = stroked(R.color.instrument_aircraft, 5f)
    private val cross = stroked(R.color.bad, 5f)
    private val label = Paint(Paint.ANTI_ALIAS_FLAG).apply {
        color = context.getColor(R.color.instrument_line)
        textSize = LABEL_DP * density
        textAlign = Paint.Align.CENTER
        isFakeBoldText = true
    }
    private val outline = Path()
    private val pointer = Path()
    private val density get() = resources.displayMetrics.density

    init {
        contentDescription = context.getString(R.string.attitude_unknown)
    }

    /** Shows an attitude, in rad; null is not known. */
    fun show(rollRad: Double?, pitchRad: Double?) {
        val isKnown = rollRad != null && pitchRad != null && rollRad.isFinite() && pitchRad.isFinite()
        val roll = if (isKnown) (rollRad!! / Units.DEGREE_RAD).toFloat() else 0f
        val pitch = if (isKnown) (pitchRad!! / Units.DEGREE_RAD).toFloat() else 0f
        if (isKnown == this.isKnown && roll == rollDeg && pitch == pitchDeg) return
        this.isKnown = isKnown
        rollDeg = roll
        pitchDeg = pitch
        describe()
        invalidate()
    }

    private fun describe() {
        val words = if (!isKnown) {
            context.getString(R.string.attitude_unknown)
        } else {
            val (roll, pitch) = rollDeg.roundToInt() to pitchDeg.roundToInt()
            context.getString(
                R.string.attitude_described,
                abs(roll),
                context.getString(if (roll < 0) R.string.left else R.string.right),
                abs(pitch),
                context.getString(if (pitch < 0) R.string.down else R.string.up),
            )
        }
        if (words != contentDescription) contentDescription = words
    }

    override fun onSizeChanged(width: Int, height: Int, oldWidth: Int, oldHeight: Int) {
        outline.reset()
        val corner = CORNER_DP * density
        outline.addRoundRect(0f, 0f, width.toFloat(), height.toFloat(), corner, corner, Path.Direction.CW)
    }

    override fun onDraw(canvas: Canvas) {
        canvas.save()
        canvas.clipPath(outline)
        if (isKnown) drawAttitude(canvas) else drawUnknown(canvas)
        canvas.restore()
    }

    private fun drawUnknown(canvas: Canvas) {
        val (width, height) = width.toFloat() to height.toFloat()
        canvas.drawRect(0f, 0f, width, height, unknown)
        canvas.drawLine(0f, 0f, width, height, cross)
        canvas.drawLine(0f, height, width, 0f, cross)
    }

    private fun drawAttitude(canvas: Canvas) {
        val (centerX, centerY) = width / 2f to height / 2f
        val far = (width + height).toFloat() * FAR
        val degree = height / SHOWN_PITCH_DEG
        canvas.save()
        canvas.translate(centerX, centerY)
        canvas.rotate(-rollDeg)
        canvas.save()
        canvas.translate(0f, pitchDeg * degree)
        canvas.drawRect(-far, -far, far, 0f, sky)
        canvas.drawRect(-far, 0f, far, far, ground)
        canvas.drawLine(-far, 0f, far, 0f, line)
        drawLadder(canvas, degree)
        canvas.restore()
        drawRollScale(canvas)
        canvas.restore()
        drawAircraft(canvas, centerX, centerY)
    }

    /** The lines that are near: others would be under the roll scale. */
    private fun drawLadder(canvas: Canvas, degree: Float) {
        val half = min(width, height) * LADDER
        for (tens in -8..8) {
            val shown = tens * 10
            if (shown == 0 || abs(shown - pitchDeg) > SHOWN_LADDER_DEG) continue
            val y = -shown * degree
            canvas.drawLine(-half, y, half, y, line)
            val baseline = y + label.textSize / 3
            canvas.drawText("${abs(shown)}", -half - label.textSize, baseline, label)
            canvas.drawText("${abs(shown)}", half + label.textSize, baseline, label)
        }
    }

    /** Turns with the horizon; the pointer is fixed to the aircraft. */
    private fun drawRollScale(canvas: Canvas) {
        val radius = min(width, height) / 2f - 6 * density
        for (mark in ROLL_MARKS_DEG) {
            canvas.save()
            canvas.rotate(mark.toFloat())
            val length = (if (mark % 30 == 0) 12 else 8) * density
            canvas.drawLine(0f, -radius, 0f, -radius + length, line)
            canvas.restore()
        }
        canvas.save()
        canvas.rotate(rollDeg)
        val top = -radius + 13 * density
        pointer.reset()
        pointer.moveTo(0f, top)
        pointer.lineTo(-7 * density, top + 12 * density)
        pointer.lineTo(7 * density, top + 12 * density)
        pointer.close()
        canvas.drawPath(pointer, filledAircraft)
        canvas.restore()
    }

    private fun drawAircraft(canvas: Canvas, x: Float, y: Float) {
        val wing = min(width, height) * WING
        val inner = wing / 3
        canvas.drawLine(x - wing, y, x - inner, y, aircraft)
        canvas.drawLine(x - inner, y, x - inner, y + 10 * density, aircraft)
        canvas.drawLine(x + wing, y, x + inner, y, aircraft)
        canvas.drawLine(x + inner, y, x + inner, y + 10 * density, aircraft)
        canvas.drawCircle(x, y, 4 * density, filledAircraft)
    }

    private val filledAircraft = filled(R.color.instrument_aircraft)

    private fun filled(color: Int) = Paint(Paint.ANTI_ALIAS_FLAG).apply { this.color = context.getColor(color) }

    private fun stroked(color: Int, widthDp: Float) = filled(color).apply {
        style = Paint.Style.STROKE
        strokeWidth = widthDp * context.resources.displayMetrics.density
        strokeCap = Paint.Cap.ROUND
    }

    private companion object {
        const val CORNER_DP = 8
        const val LABEL_DP = 13
        /** Degrees of pitch from the lower to the upper edge. */
        const val SHOWN_PITCH_DEG = 50f
        const val SHOWN_LADDER_DEG = 15f
        /** Half a line of the ladder, and half the wing, as parts of the smaller side. */
        const val LADDER = 0.12f
        const val WING = 0.34f
        const val FAR = 2f
        val ROLL_MARKS_DEG = intArrayOf(-60, -45, -30, -20, -10, 0, 10, 20, 30, 45, 60)
    }
}
