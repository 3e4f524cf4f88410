// Decodes a stream of MAVLink frames by node-mavlink, and prints what it found as JSON.
// Argument: the file with the stream.
import { createReadStream } from 'node:fs'
import { Writable } from 'node:stream'
import { pipeline } from 'node:stream/promises'
import {
  common, development, MavLinkPacketParser, MavLinkPacketSplitter, minimal, standard,
} from 'node-mavlink'

const registry = {
  ...minimal.REGISTRY, ...standard.REGISTRY, ...common.REGISTRY, ...development.REGISTRY,
}
const crcErrors = []
const splitter = new MavLinkPacketSplitter({}, { onCrcError: (frame) => crcErrors.push(frame.length) })
const last = new Map()
const found = { bytes: 0, frames: 0, gaps: 0, wrong: 0, names: {}, unknown: {} }

function take(packet) {
  const { sysid, compid, seq, msgid } = packet.header
  found.frames += 1
  found.bytes += packet.buffer.length
  const sender = `${sysid}/${compid}`
  if (last.has(sender) && seq !== (last.get(sender) + 1) % 256) found.gaps += 1
  last.set(sender, seq)
  const type = registry[msgid]
  if (!type) {
    found.unknown[msgid] = (found.unknown[msgid] ?? 0) + 1
    return
  }
  const data = packet.protocol.data(packet.payload, type)
  // Every field is there.
  if (type.FIELDS.some(({ name }) => data[name] === undefined)) found.wrong += 1
  found.names[type.MSG_NAME] = (found.names[type.MSG_NAME] ?? 0) + 1
}

await pipeline(
  createReadStream(process.argv[2]), splitter, new MavLinkPacketParser(),
  new Writable({ objectMode: true, write: (packet, _, done) => { take(packet); done() } }),
)
found.crcErrors = crcErrors.length
found.notKnownToSplitter = splitter.unknownPackagesCount
console.log(JSON.stringify(found))
