// Android Gradle Plugin 8.13 needs Gradle 8.13 and Java 17.
plugins {
    id("com.android.application") version "8.13.0" apply false
    // As in tests/pom.xml.
    id("org.jetbrains.kotlin.android") version "2.2.20" apply false
}
