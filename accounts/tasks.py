"""Periodic clean-up and re-encryption."""

from celery import shared_task

from accounts import login, second_factors


@shared_task(time_limit=30, soft_time_limit=25)
def forget_old_sign_ins() -> None:
    login.forget_old_sign_ins()


@shared_task(time_limit=60, soft_time_limit=50)
def seal_second_factors() -> None:
    second_factors.encrypt_with_current_key()
