"""The parts of decentralised Monte-Carlo tree search: whose plan is good given the others'.

G. Best, O. M. Cliff, T. Patten, R. R. Mettu and R. Fitch, "Dec-MCTS: Decentralized planning for
multi-robot active perception", International Journal of Robotics Research 38(2-3), 2019. `tree`
grows by simulations, `plans` are each agent's distribution over the best sequences of its tree;
`tours` simulates one who collects, `sights` one who looks; `foraging` and `scouting` let the agents
of a group take turns. What is believed, and how those who lost touch find each other, is
`mjforage.graph_planner.belief_planner`'s.
"""
