"""Multi-agent PPO (Yu et al. 2022) with TorchRL's loss: actors per team, a critic that sees all.

`hyperparameters` the settings, `critic_features` the input of the critic alone, `critic` its
network, `rollout` the decisions of a round, `updates` losses and steps by TorchRL, `trainer` the
loop. Only `updates` needs TorchRL.
"""
