"""The paper's learning algorithm: a Double DQN with dueling networks and prioritised replay.

`settings` what can be chosen, `replay` the memory, `ddqn` the algorithm, `training` the loop,
`checkpoint` and `logs` its files. Needs torch, which nothing else of mjforage imports.
"""
