"""The paper's learning algorithm: a Double DQN with dueling networks and prioritised replay.

`hyperparameters` what can be chosen, `replay_memory` the decisions to learn from, `ddqn` the
algorithm, `trainer` the loop, `run` a whole run, `checkpoint` and `logs` its files. Needs torch,
which nothing else of mjforage imports.
"""
