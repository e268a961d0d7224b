"""The Python front door: scenarios, policies, runs and missions of `import mjforage as mf`."""
