"""Multi-agent PPO (Yu et al. 2022) with TorchRL's loss: actors per team, a critic that sees all.

`hyperparameters` what can be chosen, `overview` what the critic alone is shown, `critic` its
network, `rollout` the decisions of a round, `updates` what TorchRL makes of them, `trainer` the
loop. Only `updates` needs TorchRL.
"""
