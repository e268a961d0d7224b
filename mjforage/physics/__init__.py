"""The same mission in MuJoCo: vessels, weather, scene, simulation, dynamics."""
