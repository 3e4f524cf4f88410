package fcc.android

import org.junit.Assert.assertFalse
import org.junit.Assert.assertTrue
import org.junit.Test

class ConfigurationTest {
    /** Each is one that the library reads; positions are asked for by it. */
    @Test
    fun `the phone's sensors are found however they are written`() {
        for (text in listOf(
            "[[sensor]]\nkind = \"phone\"\n",
            "[[sensor]]\r\n  kind='phone'\r\n",
            "sensor = [{ kind = \"phone\" }]\n",
            "sensor = [{ position = true, kind = 'phone' }]\n",
            "[[sensor]]\n\"kind\" = \"phone\"\n",
            "[[sensor]]\nkind = \"\"\"phone\"\"\"\n",
        )) assertTrue(text, Configuration.usesPhone(text))
        for (text in listOf("#kind = \"phone\"\n", "a = 1 # kind = \"phone\"\n", "kind = \"phones\"\n", "")) {
            assertFalse(text, Configuration.usesPhone(text))
        }
    }
}
