"""The parts of decentralised Monte-Carlo tree search: plans that are good given the others'.

G. Best, O. M. Cliff, T. Patten, R. R. Mettu and R. Fitch, "Dec-MCTS: Decentralized planning for
multi-robot active perception", International Journal of Robotics Research 38(2-3), 2019. `tree`
grows by simulations, `plans` are each agent's distribution over the best sequences of its tree;
`tours` simulates a forager, `sights` a scout; `foraging` and `scouting` let the agents of a group
take turns. Beliefs, and the return to contact, are those of
`mjforage.graph_planner.belief_planner`.
"""
