"""The same mission in MuJoCo: vessels, scene, simulation, dynamics."""
