// Command telemetry-go prints altitude, airspeed and the events of a running flight, by the
// ground station's WebSocket: go run . 127.0.0.1:8460 fccd
package main

import (
	"encoding/binary"
	"encoding/json"
	"fmt"
	"log"
	"math"
	"os"

	"golang.org/x/net/websocket"
)

// frame is a message with its kind: text or binary.
type frame struct {
	kind byte
	data []byte
}

var frames = websocket.Codec{Unmarshal: func(data []byte, kind byte, into any) error {
	*into.(*frame) = frame{kind, data}
	return nil
}}

type message struct {
	Hello *struct{ Columns []struct{ Name, Kind string } }
	Event *struct{ Text string }
}

func main() {
	station, instance := os.Args[1], os.Args[2]
	ws, err := websocket.Dial("ws://"+station+"/api/live/"+instance, "", "http://"+station)
	if err != nil {
		log.Fatal(err)
	}
	index := map[string]int{}
	for {
		var got frame
		if err := frames.Receive(ws, &got); err != nil {
			log.Fatal(err)
		}
		if got.kind == websocket.TextFrame { // Text: hello first, then events, and the status each second.
			var text message
			if json.Unmarshal(got.data, &text) == nil && text.Hello != nil {
				for at, column := range text.Hello.Columns {
					index[column.Name] = at
				}
			} else if text.Event != nil {
				fmt.Println(text.Event.Text)
			}
			continue
		}
		// A tick: words of 8 bytes, little-endian, in the order of the columns.
		value := func(name string) float64 {
			return math.Float64frombits(binary.LittleEndian.Uint64(got.data[8*index[name]:]))
		}
		fmt.Printf("%.1f m  %.1f m/s\n", value("altitude_m"), value("airspeed_mps"))
	}
}
