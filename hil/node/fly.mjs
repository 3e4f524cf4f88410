// Flies an AR.Drone by the package ar-drone: takes off, goes forward, turns, and lands. Prints what
// it was told as JSON. Argument: the drone's address.
import arDrone from 'ar-drone'

const client = arDrone.createClient({ ip: process.argv[2] })
const told = { states: [], forward: [], headings: [], heights: [] }
let phase = 'waits'

client.on('navdata', ({ demo }) => {
  if (!demo) return
  const state = demo.controlState.replace('CTRL_', '')
  if (told.states.at(-1) !== state) told.states.push(state)
  if (phase === 'forward') told.forward.push([demo.rotation.pitch, demo.velocity.x])
  if (phase === 'turns') told.headings.push(demo.rotation.clockwise)
  if (phase === 'hovers') told.heights.push(demo.altitude)
})

const until = (event) => new Promise((done) => client.once(event, done))
const seconds = (s) => new Promise((done) => setTimeout(done, 1000 * s))

client.takeoff()
await until('hovering')
phase = 'hovers'
await seconds(2)
phase = 'forward'
client.front(0.5)
await seconds(2)
client.stop()
phase = 'brakes'
await seconds(3)
phase = 'turns'
client.clockwise(0.5)
await seconds(2)
client.stop()
phase = 'lands'
await seconds(1)
client.land()
await until('landed')
console.log(JSON.stringify(told))
process.exit(0)
