package fcc.android

import org.junit.Assert.assertEquals
import org.junit.Assert.assertNull
import org.junit.Test

class NmeaTest {
    /** The sentence that D. DePriest, "NMEA data" (gpsinformation.org), explains. */
    private val gga = "\$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47"

    @Test
    fun `the geoid of a textbook's sentence`() {
        assertEquals(46.9, Nmea.geoidM("$gga\r\n")!!, 0.0)
    }

    @Test
    fun `what is damaged or another sentence says nothing`() {
        for (at in gga.indices) {
            assertNull(gga.take(at), Nmea.geoidM(gga.take(at)))
            val changed = gga.replaceRange(at, at + 1, if (gga[at] == '1') "2" else "1")
            assertNull(changed, Nmea.geoidM(changed))
        }
        assertNull(Nmea.geoidM("\$GPGSA,A,3,04,05,,09,12,,,24,,,,,2.5,1.3,2.1*39"))
    }
}
