package fcc.android

/** NMEA 0183, as far as Android's locations lack it before Android 14. */
object Nmea {
    private const val GEOID_FIELD = 11
    private const val HEX = 16

    /** The geoid above the ellipsoid of a GGA sentence, m; null of anything else. */
    fun geoidM(sentence: String): Double? {
        val (body, sum) = Regex("""^\$([^*$]*)\*([0-9A-Fa-f]{2})\s*$""").find(sentence)?.destructured ?: return null
        val fields = body.split(",")
        val isWhole = body.fold(0) { all, char -> all xor char.code } == sum.toInt(HEX)
        return when {
            !isWhole || !fields[0].endsWith("GGA") -> null
            fields.getOrNull(GEOID_FIELD + 1) != "M" -> null
            else -> fields[GEOID_FIELD].toDoubleOrNull()?.takeIf { it.isFinite() }
        }
    }
}
