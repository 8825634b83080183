from harness.execution.compile import *


def refuse_constructs(step):
    pass


def sentence(step, fault):
    return str(fault)


def foreign_sentence(step, foreign):
    return str(foreign)
