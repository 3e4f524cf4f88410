package fcc.android

/** What the native library throws; the message is for the user. */
sealed class FccException(message: String) : Exception(message)

/** The configuration cannot be flown: every problem with its line and key. */
class ConfigException(message: String) : FccException(message)

/** A flight did not begin. */
class FlightException(message: String) : FccException(message)

/** A command was refused, or nothing flies. */
class CommandException(message: String) : FccException(message)

/** The recordings cannot be listed, or one cannot be read. */
class RecordingException(message: String) : FccException(message)

/** A calibration did not begin. */
class CalibrationException(message: String) : FccException(message)

/** The flight computer is closed. */
class ClosedException(message: String) : FccException(message)

/** The package of the app has no library for this processor. */
class LibraryException(why: String) :
    FccException("this app has no native library for this processor: install the package that is for it ($why)")

/** An error of the library itself. */
class InternalException(message: String) : FccException(message)
