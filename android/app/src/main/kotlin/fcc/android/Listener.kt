package fcc.android

/**
 * Is told what happens in flight, in a thread of its own, one call at a time: what
 * it does delays nothing. What it throws is ignored. While a call takes long,
 * later ones wait; beyond 256 they are left out.
 */
interface Listener {
    /** The loop's state is now `standby`, `engaged`, `failsafe` or `stopped`. */
    fun stateChanged(state: String)

    /** An event of the loop, or a remark about the flight. */
    fun reported(text: String)

    /** The flight is over, the controls are released, the recording is finished. */
    fun ended(reason: String)
}
