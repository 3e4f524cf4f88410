module telemetry-go

go 1.23

require golang.org/x/net v0.35.0
